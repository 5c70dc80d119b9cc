#pragma once

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/mapping/file/map_description.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::simulator {

/// The map that the mapper would build of a run if depth and labels were exact and every pose were true.
class IdealMap {
 public:
  /// It is built like the mapper's map, except for the kernel of the fusion rule "bki".
  /// @throws std::runtime_error naming the value that is out of range.
  IdealMap(double resolution_m, const mapping::FrameSettings& frames);

  /// Adds a frame without noise. @param T_map_camera true pose of the optical frame in the run's map frame.
  /// @throws std::runtime_error when image sizes and camera disagree.
  void add(const geometry::PinholeCamera& camera, const geometry::Pose& T_map_camera, const geometry::DepthImage& depth,
           const geometry::LabelImage& labels);

  const mapping::VoxelMap& map() const { return map_; }
  const mapping::FrameSettings& frame_settings() const { return frames_; }

 private:
  mapping::FrameSettings frames_;
  mapping::VoxelMap map_;
};

}  // namespace lapis::simulator
