#include "planner/core/exploration/progress_watch.hpp"

#include <algorithm>

namespace lapis::planner {
namespace {

constexpr double kLeast_m3 = 0.5, kLeastShare = 1e-3;
constexpr double kSlow_m_s = 0.25;     // speed on a path that makes progress
constexpr double kLongestGap_s = 5.0;  // between calls; in a longer gap the robot did not explore

}  // namespace

void ProgressWatch::note(double explored_m3, const Eigen::Vector2d& robot_map, time::Time now) {
  const double passed_s = robot_map_ ? (now - noted_at_).seconds() : 0.0;
  if (robot_map_ && passed_s <= kLongestGap_s) {
    driven_m_ += (robot_map - *robot_map_).norm();
    passed_s_ += passed_s;
  }
  robot_map_ = robot_map;
  noted_at_ = now;
  const double least_m3 = std::max(kLeast_m3, kLeastShare * explored_m3_);
  const bool has_shrunk = explored_m3 <= explored_m3_ - least_m3;  // by a correction of the map, not by jitter
  const bool is_progress = explored_m3 >= explored_m3_ + least_m3;
  if (has_shrunk || is_progress) explored_m3_ = explored_m3;
  if (is_progress) begin_anew();
}

void ProgressWatch::set_out(double cost_m) { longest_m_ = std::max(longest_m_, cost_m); }

bool ProgressWatch::is_stalled() const {
  return driven_m_ > allowance_.metres + 2.0 * longest_m_ ||
         passed_s_ > allowance_.seconds + 2.0 * longest_m_ / kSlow_m_s;
}

void ProgressWatch::begin_anew() { driven_m_ = longest_m_ = passed_s_ = 0.0; }

}  // namespace lapis::planner
