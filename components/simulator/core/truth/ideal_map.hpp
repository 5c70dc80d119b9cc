#pragma once

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/integration.hpp"
#include "common/mapping/voxel_map.hpp"

namespace lapis::simulator {

/// How the mapper builds its map; the reference must be built alike.
struct IdealMapConfig {
  double resolution_m = 0.25;
  mapping::IntegrationConfig integration;
  mapping::CompactFrameConfig frame;
};

/// The map that the mapper would make of a run if depth and labels were exact and every pose true: the paper's
/// reference.
class IdealMap {
 public:
  /// @throws std::runtime_error naming the value that is out of range.
  explicit IdealMap(const IdealMapConfig& config);

  /// Adds a frame without noise. @param T_map_camera true pose of the optical frame in the run's map frame.
  /// @throws std::runtime_error when image sizes and camera disagree.
  void add(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera, const geometry::DepthImage& depth,
           const geometry::LabelImage& labels);

  const mapping::VoxelMap& map() const { return map_; }

 private:
  IdealMapConfig config_;
  mapping::VoxelMap map_;
};

}  // namespace lapis::simulator
