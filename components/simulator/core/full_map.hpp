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
  std::stop_token cancelled{};  ///< once asked to stop, the result is worthless and comes soon
};

/// The map that the mapper would make of the whole building if depth and labels were exact and every pose true, of a
/// robot that looks all round in every square metre that it can get to: what the paper compares maps with. In the run's
/// map frame.
/// @throws std::runtime_error when the robot does not fit at its start
IdealMap make_full_map(const World& world, const geometry::Pose& T_world_base, const FullMapConfig& config);

/// All that a full map depends on, as text: equal texts, equal maps.
std::string made_of(const World& world, const geometry::Pose& T_world_base, const FullMapConfig& config);

}  // namespace lapis::simulator
