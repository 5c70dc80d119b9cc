#include "planner/core/exploration/trail.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>

namespace lapis::planner {
namespace {

constexpr std::size_t kPoses = 50;       // number of remembered poses
constexpr double kLeastTurn_rad = 0.01;  // least turn between poses that is not noise

}  // namespace

void Trail::add(const Pose2& tracked) {
  const double turn_rad = newest_ ? std::remainder(tracked.yaw_rad - newest_->yaw_rad, 2.0 * std::numbers::pi) : 0.0;
  if (std::abs(turn_rad) > kLeastTurn_rad) turned_left_ = turn_rad > 0.0;
  newest_ = tracked;
  if (poses_.empty() || has_moved(poses_.back(), tracked)) poses_.push_back(tracked);
  if (poses_.size() > kPoses) poses_.pop_front();
}

void Trail::turn_back() {
  if (newest_) poses_.push_back(*newest_);
}

void Trail::drop_nearest(const Pose2& place) {
  const auto difference = [&](const Pose2& p) {
    return (p.p_map - place.p_map).norm() + turn_between(p.yaw_rad, place.yaw_rad);
  };
  const auto nearest = std::min_element(poses_.begin(), poses_.end(),
                                        [&](const Pose2& a, const Pose2& b) { return difference(a) < difference(b); });
  if (nearest != poses_.end()) poses_.erase(nearest);
}

void Trail::clear() {
  poses_.clear();
  newest_.reset();
  turned_left_ = false;
}

}  // namespace lapis::planner
