#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "common/mapping/model/label_list.hpp"
#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::semantic_mapper {

/// Occupied voxel: its centre in the map frame [m].
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

/// The map as an OctoMap ColorOcTree: one leaf per observed voxel on the same grid. The value of a leaf is the
/// occupancy log-odds; its colour is that of the class for occupied voxels, and white for free ones. Leaves are not
/// pruned, because OctoMap would merge equal occupancy of different classes and mix their colours. Voxels further than
/// 32,768 cells from the origin do not fit and are left out.
struct Octree {
  std::vector<std::uint8_t> file;  ///< content of a .ot file
  std::vector<std::uint8_t> tree;  ///< the nodes alone, without the file's header
};
Octree encode_octree(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                     const mapping::LabelList& labels);

/// The same leaves as OctoMap's compact binary tree (.bt), which distinguishes occupied from free and nothing else.
std::vector<std::uint8_t> encode_binary_octree(const mapping::VoxelMap& map, const mapping::BeliefReader& reader);

}  // namespace lapis::semantic_mapper
