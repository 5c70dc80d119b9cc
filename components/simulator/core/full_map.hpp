#pragma once

#include <stop_token>
#include <string>

#include "common/geometry/camera_mount.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "simulator/core/truth/ideal_map.hpp"
#include "simulator/core/world.hpp"

namespace lapis::simulator {

struct FullMapConfig {
  double resolution_m = mapping::kDefaultResolution_m;
  mapping::FrameSettings frames;
  geometry::PinholeCamera camera;
  geometry::CameraMount mount;
  double robot_radius_m = 0.2;
  std::stop_token cancelled{};  ///< after a request to stop, the result comes soon and is incomplete
};

/// The map that the mapper would build of the whole building if depth and labels were exact, every pose were true, and
/// the robot looked all round in every square metre that it can reach. The paper compares maps with it. It is in the
/// run's frame `map`.
/// @throws std::runtime_error when the robot does not fit at its start
IdealMap make_full_map(const World& world, const geometry::Pose& T_world_base, const FullMapConfig& config);

/// Text of everything that a full map depends on: equal texts mean equal maps.
std::string made_of(const World& world, const geometry::Pose& T_world_base, const FullMapConfig& config);

}  // namespace lapis::simulator
