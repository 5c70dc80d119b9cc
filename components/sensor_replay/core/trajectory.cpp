#include "sensor_replay/core/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "sensor_replay/core/text_table.hpp"

namespace lapis::sensor_replay {
namespace {

constexpr std::size_t kFields = 8;
constexpr double kMaxNormError = 1e-2;  // files with four decimals are well below

StampedPose parse_pose(const std::filesystem::path& file, const TableRow& row) {
  if (row.fields.size() != kFields) {
    fail_at(file, row.line, std::to_string(row.fields.size()) + " fields instead of 8 (stamp tx ty tz qx qy qz qw)");
  }
  const auto stamp = parse_stamp(row.fields[0]);
  if (!stamp) fail_at(file, row.line, "\"" + row.fields[0] + "\" is not a time stamp in decimal seconds");
  std::array<double, kFields> v{};
  for (std::size_t i = 1; i < kFields; ++i) {
    const auto number = parse_number(row.fields[i]);
    if (!number) fail_at(file, row.line, "\"" + row.fields[i] + "\" is not a finite number");
    v[i] = *number;
  }
  const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
  if (std::abs(rotation.norm() - 1.0) > kMaxNormError) {
    fail_at(file, row.line, "quaternion of length " + std::to_string(rotation.norm()) + " instead of 1");
  }
  return {*stamp, geometry::make_pose({v[1], v[2], v[3]}, rotation)};
}

}  // namespace

std::vector<StampedPose> read_trajectory(const std::filesystem::path& file) {
  std::vector<StampedPose> poses;
  for (const TableRow& row : read_table(file)) {
    const StampedPose pose = parse_pose(file, row);
    if (!poses.empty() && pose.stamp <= poses.back().stamp) {
      fail_at(file, row.line,
              "time stamps are not sorted or occur twice: " + time::to_string(pose.stamp) + " after " +
                  time::to_string(poses.back().stamp));
    }
    poses.push_back(pose);
  }
  return poses;
}

std::optional<geometry::Pose> interpolate(const std::vector<StampedPose>& trajectory, time::Time stamp,
                                          time::Duration max_difference) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                                      [](const StampedPose& pose, time::Time t) { return pose.stamp < t; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp == stamp) return after->T_world_camera;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (std::min(stamp - before->stamp, after->stamp - stamp) > max_difference) return std::nullopt;

  const double share = (stamp - before->stamp).seconds() / (after->stamp - before->stamp).seconds();
  const geometry::Pose& A = before->T_world_camera;
  const geometry::Pose& B = after->T_world_camera;
  const Eigen::Quaterniond rotation = Eigen::Quaterniond(A.linear()).slerp(share, Eigen::Quaterniond(B.linear()));
  return geometry::make_pose((1.0 - share) * A.translation() + share * B.translation(), rotation);
}

}  // namespace lapis::sensor_replay
