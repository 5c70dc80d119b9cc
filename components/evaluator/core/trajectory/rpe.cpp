#include "evaluator/core/trajectory/rpe.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lapis::evaluator {
namespace {

// Distance of a pose from the start of the trajectory (in seconds, metres or frames), and its match, if any.
struct Milestone {
  double travelled = 0.0;
  const Match* match = nullptr;
};

std::vector<Milestone> milestones_by_time(const Trajectory& estimate, std::span<const Match> matches) {
  std::vector<Milestone> milestones;
  for (const StampedPose& pose : estimate) {
    milestones.push_back({(pose.stamp - estimate.front().stamp).seconds(), nullptr});
  }
  for (const Match& match : matches) milestones.at(match.estimate_index).match = &match;
  return milestones;
}

std::vector<Milestone> milestones_by_match(std::span<const Match> matches, DeltaUnit unit) {
  std::vector<Milestone> milestones;
  double travelled = 0.0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (i > 0) {
      const Eigen::Vector3d step =
          matches[i].T_world_reference.translation() - matches[i - 1].T_world_reference.translation();
      travelled += unit == DeltaUnit::kMetres ? step.norm() : 1.0;
    }
    milestones.push_back({travelled, &matches[i]});
  }
  return milestones;
}

const Milestone& nearest(const std::vector<Milestone>& milestones, double target) {
  const auto after = std::lower_bound(milestones.begin(), milestones.end(), target,
                                      [](const Milestone& m, double value) { return m.travelled < value; });
  if (after == milestones.begin()) return *after;
  const auto before = after - 1;
  if (after == milestones.end()) return *before;
  return target - before->travelled <= after->travelled - target ? *before : *after;
}

IntervalError interval_error(const Match& start, const Match& end, MotionError kind) {
  const geometry::Pose A = start.T_world_estimate.inverse() * end.T_world_estimate;
  const geometry::Pose B = start.T_world_reference.inverse() * end.T_world_reference;
  const geometry::Pose error = kind == MotionError::kBenchmark ? A * B.inverse() : B.inverse() * A;
  return {start.stamp, end.stamp, error.translation().norm(), geometry::rotation_angle(error.linear())};
}

std::vector<IntervalError> interval_errors(const std::vector<Milestone>& milestones,
                                           const RelativeErrorConfig& config) {
  std::vector<IntervalError> intervals;
  for (const Milestone& start : milestones) {
    const double target = start.travelled + config.delta;
    const double last = milestones.back().travelled;
    const Milestone& end = nearest(milestones, target);
    const bool is_cut_off = config.unit == DeltaUnit::kFrames ? target > last : end.travelled >= last;
    if (is_cut_off || start.match == nullptr || end.match == nullptr || start.match == end.match) continue;
    intervals.push_back(interval_error(*start.match, *end.match, config.motion_error));
  }
  return intervals;
}

}  // namespace

std::optional<RelativeError> relative_error(const Trajectory& estimate, std::span<const Match> matches,
                                            const RelativeErrorConfig& config) {
  if (!(config.delta > 0.0)) throw std::invalid_argument("the length of RPE intervals must be positive");
  if (matches.empty()) return std::nullopt;
  const auto milestones = config.unit == DeltaUnit::kSeconds ? milestones_by_time(estimate, matches)
                                                             : milestones_by_match(matches, config.unit);
  RelativeError result;
  result.intervals = interval_errors(milestones, config);
  if (result.intervals.empty()) return std::nullopt;
  std::vector<double> translations;
  std::vector<double> rotations;
  for (const IntervalError& interval : result.intervals) {
    translations.push_back(interval.translation_m);
    rotations.push_back(interval.rotation_rad);
  }
  result.translation_m = *error_statistics(std::move(translations));
  result.rotation_rad = *error_statistics(std::move(rotations));
  return result;
}

}  // namespace lapis::evaluator
