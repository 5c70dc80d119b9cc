#include "planner/core/decision/first_turn.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lapis::planner {
namespace {

constexpr double kLeast_rad = 1.75;  // during a smaller turn, part of the first or of the last view is always visible
constexpr double kStep_rad = 0.5;    // between headings
constexpr int kEnough = 30;          // number of landmarks in view with which slam tracks

std::vector<double> headings_through(double from_rad, double turn_rad) {
  const double steps = std::ceil(std::abs(turn_rad) / kStep_rad);
  std::vector<double> headings_rad;
  for (double i = 1.0; i <= steps; i += 1.0) headings_rad.push_back(from_rad + turn_rad * i / steps);
  return headings_rad;
}

/// Largest number of landmarks of one old key-frame that are in view: slam tracks against a single key-frame.
int landmarks_in_view(const Situation& s, double heading_rad, const CovisibilityConfig& config) {
  const auto seen =
      s.landmarks->predict(s.view.config().camera, camera_at(s, {s.robot.p_map, heading_rad}), s.field, config);
  int most = 0;
  for (const Covisibility& of_keyframe : seen) most = std::max(most, of_keyframe.landmarks);
  return most;
}

bool keeps_landmarks(const Situation& s, const std::vector<double>& headings_rad, const CovisibilityConfig& config) {
  return std::all_of(headings_rad.begin(), headings_rad.end() - 1,
                     [&](double heading_rad) { return landmarks_in_view(s, heading_rad, config) >= kEnough; });
}

}  // namespace

std::vector<double> first_turn(const Situation& situation, double heading_rad, int side,
                               const CovisibilityConfig& config) {
  const double shorter_rad = std::remainder(heading_rad - situation.robot.yaw_rad, 2.0 * std::numbers::pi);
  if (situation.landmarks == nullptr || std::abs(shorter_rad) < kLeast_rad) return {};
  const double longer_rad = shorter_rad - std::copysign(2.0 * std::numbers::pi, shorter_rad);
  if (side != 0) return headings_through(situation.robot.yaw_rad, side * longer_rad > 0.0 ? longer_rad : shorter_rad);
  std::vector<double> longer = headings_through(situation.robot.yaw_rad, longer_rad);
  const bool is_better = !keeps_landmarks(situation, headings_through(situation.robot.yaw_rad, shorter_rad), config) &&
                         keeps_landmarks(situation, longer, config);
  return is_better ? longer : std::vector<double>{};
}

}  // namespace lapis::planner
