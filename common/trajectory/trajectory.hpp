#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"

namespace lapis::trajectory {

/// Pose of a moving frame (camera or robot body) in a fixed frame at one time.
struct StampedPose {
  time::Time stamp;
  geometry::Pose T_world_body = geometry::Pose::Identity();
};

/// Poses with strictly increasing stamps.
using Trajectory = std::vector<StampedPose>;

/// Reads TUM text: `timestamp tx ty tz qx qy qz qw` per line [s, m]; `#` starts a comment; commas count as spaces.
/// Quaternions are normalised when their norm is within 1e-3 of one. Throws std::runtime_error with "source:line:
/// reason" on wrong columns, numbers that are not finite, other quaternions, and stamps that do not increase.
Trajectory parse_trajectory(std::string_view text, const std::string& source);
/// parse_trajectory() of a file; throws std::runtime_error also when the file cannot be read or contains no pose.
Trajectory read_trajectory(const std::filesystem::path& file);

/// TUM text with nine decimals and quaternions with w >= 0, so that equal trajectories give equal bytes. `comment`
/// (frames, meaning) becomes the first line.
std::string format_trajectory(const Trajectory& trajectory, const std::string& comment);
/// Writes format_trajectory() to a file. The text is written to another file that is then renamed, so that a kill
/// leaves the old file intact. Throws std::runtime_error, which names the file.
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory, const std::string& comment);

/// Sum of the straight distances between successive positions [m].
double path_length_m(const Trajectory& trajectory);
/// Pose at `stamp`, interpolated between the two neighbouring poses: linearly in translation, spherically linearly in
/// rotation. There is no extrapolation: empty before the first and after the last pose, and when the nearer of the two
/// is not closer than `max_difference`. A pose with exactly this stamp is always found.
std::optional<geometry::Pose> pose_at(const Trajectory& trajectory, time::Time stamp, time::Duration max_difference);

/// The same trajectory seen from another fixed frame: each pose becomes T_new_world * T_world_body.
Trajectory express_in(const geometry::Pose& T_new_world, const Trajectory& trajectory);

}  // namespace lapis::trajectory
