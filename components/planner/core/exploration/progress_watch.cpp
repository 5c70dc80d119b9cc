#include "planner/core/exploration/progress_watch.hpp"

#include <algorithm>

namespace lapis::planner {

void ProgressWatch::note(double explored_m3, const Eigen::Vector2d& robot_map) {
  if (robot_map_) driven_m_ += (robot_map - *robot_map_).norm();
  robot_map_ = robot_map;
  if (explored_m3 < explored_m3_ + kProgress_m3) return;
  explored_m3_ = explored_m3;
  begin_anew();
}

void ProgressWatch::set_out(double cost_m) { longest_m_ = std::max(longest_m_, cost_m); }

void ProgressWatch::begin_anew() { driven_m_ = longest_m_ = 0.0; }

}  // namespace lapis::planner
