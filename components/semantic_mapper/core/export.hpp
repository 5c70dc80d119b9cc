#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "common/mapping/label_list.hpp"
#include "common/mapping/sensor_model.hpp"
#include "common/mapping/voxel_map.hpp"

namespace lapis::semantic_mapper {

/// Centre of an occupied voxel in the map frame [m].
struct LabelledPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  geometry::Rgb8 color;  ///< of the class
  std::uint16_t label = 0;
  float probability = 0.0f;  ///< P(occupied)
};

/// Occupied voxels (P > 0.5) in canonical order.
std::vector<LabelledPoint> occupied_points(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                                           const mapping::LabelList& labels);

/// Binary little-endian PLY: vertices x y z (float), red green blue (uchar), label (ushort), probability (float).
std::vector<std::uint8_t> encode_ply(std::span<const LabelledPoint> points);

/// The map as OctoMap ColorOcTree: one leaf per observed voxel at the same grid, value = occupancy log-odds, colour =
/// the class' for occupied voxels and white for free ones. Leaves are not pruned: OctoMap would merge equal occupancy
/// of different classes and mix their colours. Voxels further than 32,768 cells from the origin do not fit and are left
/// out.
struct Octree {
  std::vector<std::uint8_t> file;  ///< content of a .ot file
  std::vector<std::uint8_t> tree;  ///< the nodes alone, without the file's header
};
Octree encode_octree(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                     const mapping::LabelList& labels);

struct GridConfig {
  double min_height_m = 0.2;  ///< voxels whose centre is below say nothing about the floor plan; above the floor
  double max_height_m = 1.2;  ///< voxels whose centre is at or above say nothing; above the robot's top
};

/// Floor plan in the map frame. Cell (column, row) covers [origin + column * resolution, + resolution) and so on.
struct OccupancyGrid {
  double resolution_m = 0.0;
  double origin_x_m = 0.0;
  double origin_y_m = 0.0;
  int width = 0;                   ///< columns, along x
  int height = 0;                  ///< rows, along y
  std::vector<std::int8_t> cells;  ///< row by row: 100 occupied, 0 free, -1 unknown
};

/// Projects the voxels whose centre lies in [min_height_m, max_height_m): a column with any occupied voxel (P > 0.5) is
/// 100; otherwise one with any free voxel is 0; otherwise -1. The grid spans the observed voxels of that band.
OccupancyGrid project_to_grid(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                              const GridConfig& config);

}  // namespace lapis::semantic_mapper
