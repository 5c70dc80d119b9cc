#include "planner/core/exploration/trail.hpp"

#include <cstddef>

namespace lapis::planner {
namespace {

constexpr std::size_t kPoses = 50;  // that are remembered

}  // namespace

void Trail::add(const Pose2& tracked) {
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
}

}  // namespace lapis::planner
