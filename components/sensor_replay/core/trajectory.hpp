#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"

namespace lapis::sensor_replay {

/// True pose of the camera's optical frame in the data set's own world frame.
struct StampedPose {
  time::Time stamp;
  geometry::Pose T_world_camera;
};

/// Reads a TUM trajectory ("stamp tx ty tz qx qy qz qw"), stamps strictly increasing.
/// @throws std::runtime_error naming file and line for bad numbers, quaternions that are no unit quaternions, and
///   unsorted or repeated stamps.
std::vector<StampedPose> read_trajectory(const std::filesystem::path& file);

/// Pose at a stamp: linear in translation, spherical linear in rotation between the two poses around it. Empty outside
/// the trajectory and where the nearer of the two is further away than `max_difference`: nothing is extrapolated.
std::optional<geometry::Pose> interpolate(const std::vector<StampedPose>& trajectory, time::Time stamp,
                                          time::Duration max_difference);

}  // namespace lapis::sensor_replay
