#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"

namespace lapis::trajectory {

/// Pose of a moving frame (camera or robot body) in a fixed one, at an instant.
struct StampedPose {
  time::Time stamp;
  geometry::Pose T_world_body = geometry::Pose::Identity();
};

/// Poses with strictly increasing stamps.
using Trajectory = std::vector<StampedPose>;

/// Reads TUM text: `timestamp tx ty tz qx qy qz qw` per line [s, m]; `#` starts a comment; commas count as blanks.
/// Quaternions are normalised when their norm is within 1e-3 of one. Throws std::runtime_error with
/// "source:line: reason" on wrong columns, numbers that are not finite, other quaternions, and stamps that do not
/// increase.
Trajectory parse_trajectory(std::string_view text, const std::string& source);
/// parse_trajectory on a file; throws when it cannot be read or holds no pose.
Trajectory read_trajectory(const std::filesystem::path& file);

/// TUM text with nine decimals and quaternions of w >= 0: equal trajectories give equal bytes. `comment` becomes the
/// first line (frames, meaning).
std::string format_trajectory(const Trajectory& trajectory, const std::string& comment);
/// format_trajectory to a file, written beside it and renamed: a kill leaves the old file whole. Throws
/// std::runtime_error naming the file.
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory, const std::string& comment);

/// Sum of the straight distances between successive positions [m].
double path_length_m(const Trajectory& trajectory);
/// Pose at an instant: linear in translation, spherical linear in rotation between the two poses around it. Nothing is
/// extrapolated: empty before the first and after the last pose, and where the nearer of the two is not closer than
/// `max_difference`. A pose of exactly that stamp is always found.
std::optional<geometry::Pose> pose_at(const Trajectory& trajectory, time::Time stamp, time::Duration max_difference);

/// The same trajectory seen from another fixed frame: each pose becomes T_new_world * T_world_body.
Trajectory express_in(const geometry::Pose& T_new_world, const Trajectory& trajectory);

}  // namespace lapis::trajectory
