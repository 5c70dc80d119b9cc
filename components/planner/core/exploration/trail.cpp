#include "planner/core/exploration/trail.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>

namespace lapis::planner {
namespace {

constexpr std::size_t kPoses = 50;       // that are remembered
constexpr double kLeastTurn_rad = 0.01;  // from pose to pose; less is noise

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

void Trail::drop_from(const Pose2& place) {
  const auto newer = std::find_if(poses_.rbegin(), poses_.rend(), [&](const Pose2& p) { return !has_moved(p, place); });
  if (newer != poses_.rend()) poses_.erase(std::prev(newer.base()), poses_.end());
}

void Trail::clear() {
  poses_.clear();
  newest_.reset();
  turned_left_ = false;
}

}  // namespace lapis::planner
