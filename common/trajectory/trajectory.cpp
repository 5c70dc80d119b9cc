#include "common/trajectory/trajectory.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <optional>
#include <stdexcept>

#include "common/files/atomic_file.hpp"

namespace lapis::trajectory {
namespace {

constexpr double kQuaternionTolerance = 1e-3;
// int64 nanoseconds end at 9.22e9 s.
constexpr double kMaxStampSeconds = 9.2e9;
constexpr std::size_t kColumns = 8;

[[noreturn]] void refuse(const std::string& source, std::size_t line, const std::string& reason) {
  throw std::runtime_error(source + ":" + std::to_string(line) + ": " + reason);
}

bool is_blank(char c) { return c == ' ' || c == '\t' || c == ',' || c == '\r'; }

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t begin = 0;
  while (begin < line.size()) {
    while (begin < line.size() && is_blank(line[begin])) ++begin;
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end])) ++end;
    if (end > begin) words.push_back(line.substr(begin, end - begin));
    begin = end;
  }
  return words;
}

std::optional<double> parse_number(std::string_view word) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// A double resolves an epoch stamp to 0.2 us only, so plain decimals are read digit by digit.
std::optional<time::Time> parse_stamp(std::string_view word) {
  const auto value = parse_number(word);
  if (!value || std::abs(*value) > kMaxStampSeconds) return std::nullopt;
  if (word.find_first_of("eE") != std::string_view::npos) return time::Time::from_seconds(*value);
  std::int64_t nanoseconds = 0;
  int decimals = -1;
  for (const char c : word) {
    if (c == '.') decimals = 0;
    if (c < '0' || c > '9') continue;
    if (decimals >= 9) break;
    nanoseconds = nanoseconds * 10 + (c - '0');
    if (decimals >= 0) ++decimals;
  }
  for (int i = decimals < 0 ? 0 : decimals; i < 9; ++i) nanoseconds *= 10;
  return time::Time{word.front() == '-' ? -nanoseconds : nanoseconds};
}

StampedPose parse_pose(const std::vector<std::string_view>& words, const std::string& source, std::size_t line) {
  const auto stamp = parse_stamp(words[0]);
  if (!stamp) refuse(source, line, "the stamp '" + std::string(words[0]) + "' is not a time in seconds");
  std::array<double, kColumns - 1> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto value = parse_number(words[i + 1]);
    if (!value) refuse(source, line, "'" + std::string(words[i + 1]) + "' is not a finite number");
    numbers[i] = *value;
  }
  const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (!(std::abs(q.norm() - 1.0) <= kQuaternionTolerance)) {
    refuse(
        source, line,
        "the quaternion (columns 5 to 8: x y z w) has norm " + std::to_string(q.norm()) + "; expected 1 within 0.001");
  }
  return {*stamp, geometry::make_pose({numbers[0], numbers[1], numbers[2]}, q)};
}

void append_number(std::string& text, double value) {
  std::array<char, 400> buffer{};
  std::snprintf(buffer.data(), buffer.size(), " %.9f", value);
  const std::string_view printed(buffer.data());
  text += printed == " -0.000000000" ? std::string_view(" 0.000000000") : printed;
}

}  // namespace

Trajectory parse_trajectory(std::string_view text, const std::string& source) {
  Trajectory trajectory;
  std::size_t line_number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++line_number;
    line = line.substr(0, line.find('#'));
    const auto words = split(line);
    if (words.empty()) continue;
    if (words.size() != kColumns) {
      refuse(source, line_number,
             "expected 8 columns (timestamp tx ty tz qx qy qz qw), found " + std::to_string(words.size()));
    }
    const StampedPose pose = parse_pose(words, source, line_number);
    if (!trajectory.empty() && pose.stamp <= trajectory.back().stamp) {
      const bool is_duplicate = pose.stamp == trajectory.back().stamp;
      refuse(source, line_number,
             "the stamp " + time::to_string(pose.stamp) +
                 (is_duplicate ? " is there twice" : " is earlier than the line before") + "; stamps must increase");
    }
    trajectory.push_back(pose);
  }
  return trajectory;
}

Trajectory read_trajectory(const std::filesystem::path& file) {
  std::string error;
  const auto bytes = files::read_file(file.string(), error);
  if (!bytes) throw std::runtime_error(error);
  const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  Trajectory trajectory = parse_trajectory(text, file.string());
  if (trajectory.empty()) {
    throw std::runtime_error(file.string() + ": holds no pose; expected TUM lines 'timestamp tx ty tz qx qy qz qw'");
  }
  return trajectory;
}

std::string format_trajectory(const Trajectory& trajectory, const std::string& comment) {
  std::string text = "# " + comment + "\n# timestamp tx ty tz qx qy qz qw\n";
  for (const StampedPose& pose : trajectory) {
    const Eigen::Vector3d p = pose.T_world_body.translation();
    const Eigen::Quaterniond q = geometry::unit_quaternion(pose.T_world_body);
    text += time::to_string(pose.stamp);
    for (const double value : {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()}) append_number(text, value);
    text += '\n';
  }
  return text;
}

void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory, const std::string& comment) {
  files::replace_text(file, format_trajectory(trajectory, comment));
}

double path_length_m(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length += (trajectory[i].T_world_body.translation() - trajectory[i - 1].T_world_body.translation()).norm();
  }
  return length;
}

std::optional<geometry::Pose> pose_at(const Trajectory& trajectory, time::Time stamp, time::Duration max_difference) {
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                                      [](const StampedPose& pose, time::Time t) { return pose.stamp < t; });
  if (after == trajectory.end()) return std::nullopt;
  if (after->stamp == stamp) return after->T_world_body;
  if (after == trajectory.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (std::min(stamp - before->stamp, after->stamp - stamp) >= max_difference) return std::nullopt;
  const double share = (stamp - before->stamp).seconds() / (after->stamp - before->stamp).seconds();
  const Eigen::Vector3d p_before = before->T_world_body.translation();
  const Eigen::Vector3d p_after = after->T_world_body.translation();
  const Eigen::Quaterniond q_before = geometry::unit_quaternion(before->T_world_body);
  return geometry::make_pose((1.0 - share) * p_before + share * p_after,
                             q_before.slerp(share, geometry::unit_quaternion(after->T_world_body)));
}

Trajectory express_in(const geometry::Pose& T_new_world, const Trajectory& trajectory) {
  Trajectory result = trajectory;
  for (StampedPose& pose : result) pose.T_world_body = T_new_world * pose.T_world_body;
  return result;
}

}  // namespace lapis::trajectory
