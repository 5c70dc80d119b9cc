#pragma once

#include <map>
#include <vector>

#include "common/geometry/camera_mount.hpp"
#include "planner/core/hallucination/hallucination.hpp"

namespace lapis::planner::test {

/// Camera one metre above (x, y), looking horizontally along a heading [rad].
inline geometry::Pose camera_at(double x, double y, double yaw) {
  geometry::Pose T_map_base = geometry::Pose::Identity();
  T_map_base.translate(Eigen::Vector3d(x, y, 0.0));
  T_map_base.rotate(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()));
  return T_map_base * geometry::T_base_camera({1.0, 0.0});
}

inline geometry::Matrix6d information(double position_sigma_m, double rotation_sigma_rad) {
  geometry::Vector6d diagonal;
  diagonal.head<3>().setConstant(1.0 / (position_sigma_m * position_sigma_m));
  diagonal.tail<3>().setConstant(1.0 / (rotation_sigma_rad * rotation_sigma_rad));
  return diagonal.asDiagonal();
}

/// Key-frames 10, 11, ... at the poses, joined by odometry of 1 cm and 0.01 rad.
struct Chain {
  explicit Chain(const std::vector<geometry::Pose>& poses) {
    for (const geometry::Pose& pose : poses) {
      const std::uint64_t id = 10 + keyframes.size();
      keyframes.push_back({id, pose});
      if (id > 10) edges.push_back({id - 1, id, information(0.01, 0.01)});
    }
  }
  AnalysedGraph graph() const { return std::get<AnalysedGraph>(analyse_graph(keyframes, edges)); }

  std::vector<Keyframe> keyframes;
  std::vector<KeyframeEdge> edges;
};

/// A tile of landmarks, all with the same observers.
inline std::map<mapping::TileIndex, mapping::LandmarkTile> tile_of(const std::vector<Eigen::Vector3f>& points,
                                                                   const std::vector<std::uint32_t>& observers) {
  mapping::LandmarkTile tile;
  for (const Eigen::Vector3f& p : points) {
    tile.ids.push_back(static_cast<std::uint32_t>(tile.ids.size()));
    tile.positions_m.push_back(p);
    tile.observers.insert(tile.observers.end(), observers.begin(), observers.end());
    tile.observer_ends.push_back(static_cast<std::uint32_t>(tile.observers.size()));
  }
  return {{tile.index, tile}};
}

/// A wall of landmarks at `x`, 1 m wide and high around (y, 1), 10 by 10.
inline std::vector<Eigen::Vector3f> wall_at(float x, float y = 0.0f) {
  std::vector<Eigen::Vector3f> points;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column)
      points.emplace_back(x, y - 0.45f + 0.1f * static_cast<float>(column), 0.55f + 0.1f * static_cast<float>(row));
  }
  return points;
}

inline const geometry::PinholeCamera kCamera{640, 360, 320, 320, 319.5, 179.5};

/// Everything is free but for some blocks of 2 m (voxels of 0.25 m).
inline InformationField free_field(const std::vector<mapping::BlockIndex>& walls = {}) {
  InformationField field(0.25, mapping::SensorModel{}, {Measure::kSemantic});
  std::vector<CellInformation> cells(mapping::kBlockVoxels, {1.0, 0.0});
  for (int x = -8; x < 8; ++x)
    for (int y = -8; y < 8; ++y)
      for (int z = -1; z < 2; ++z) field.set_block({x, y, z}, std::span<const CellInformation, 512>(cells));
  cells.assign(mapping::kBlockVoxels, {0.0, 0.0});
  for (const auto& wall : walls) field.set_block(wall, std::span<const CellInformation, 512>(cells));
  return field;
}

}  // namespace lapis::planner::test
