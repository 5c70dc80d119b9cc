#include "planner/core/exploration/trail.hpp"

#include <cmath>
#include <cstddef>
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

bool Trail::step_back() {
  if (poses_.size() <= 1) return false;
  poses_.pop_back();
  return true;
}

void Trail::clear() {
  poses_.clear();
  newest_.reset();
  turned_left_ = false;
}

}  // namespace lapis::planner
