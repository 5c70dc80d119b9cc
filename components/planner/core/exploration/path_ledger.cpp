#include "planner/core/exploration/path_ledger.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace lapis::planner {
namespace {

constexpr double kMetresPerRadian = 0.5;  // weight of turning when the nearest place on a path is searched
constexpr double kSameView_rad = 0.6;     // largest angle between two views that show about the same

/// Difference of position and weighted heading between two poses [m].
Eigen::Vector3d offset(const Pose2& from, const Pose2& to) {
  const Eigen::Vector2d step = to.p_map - from.p_map;
  return {step.x(), step.y(), kMetresPerRadian * std::remainder(to.yaw_rad - from.yaw_rad, 2.0 * std::numbers::pi)};
}

/// Information promised up to the robot's place on the path, interpolated between the views by position and heading. Of
/// several equally near places, the last one counts.
double promised_up_to(const std::vector<PromisedView>& views, const Pose2& robot) {
  double nats = views.empty() ? 0.0 : views.front().nats, nearest_m = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < views.size(); ++i) {
    const Eigen::Vector3d stretch = offset(views[i - 1].robot, views[i].robot);
    const Eigen::Vector3d here = offset(views[i - 1].robot, robot);
    const double length2 = stretch.squaredNorm();
    const double share = length2 > 0.0 ? std::clamp(here.dot(stretch) / length2, 0.0, 1.0) : 1.0;
    const double off_m = (here - share * stretch).norm();
    if (off_m > nearest_m) continue;
    nearest_m = off_m;
    nats = std::lerp(views[i - 1].nats, views[i].nats, share);
  }
  return nats;
}

}  // namespace

std::optional<DrivenPath> PathLedger::note(const Decision* decision, const Learnt& learnt, const Pose2& robot,
                                           time::Time now) {
  const bool continues = path_ && decision != nullptr && is_same(decision->candidates[*decision->chosen].goal);
  if (continues) return std::nullopt;
  const auto ended = end(learnt, robot, now);
  if (decision != nullptr) begin(*decision, learnt, now);
  return ended;
}

bool PathLedger::is_same(const Pose2& goal) const {
  return (goal.p_map - goal_.p_map).norm() <= radius_m_ && turn_between(goal.yaw_rad, goal_.yaw_rad) <= kSameView_rad;
}

void PathLedger::begin(const Decision& decision, const Learnt& learnt, time::Time now) {
  const Candidate& chosen = decision.candidates[*decision.chosen];
  path_.emplace();
  path_->begin = now;
  path_->kind = chosen.kind;
  path_->cost_m = chosen.value.cost_m;
  promised_ = decision.promised;
  path_->promised_nats = promised_.empty() ? 0.0 : promised_.back().nats;
  goal_ = chosen.goal;
  nats_at_begin_ = learnt.map_nats;
  loops_at_begin_.clear();
  if (!decision.known.spectrum || learnt.graph == nullptr) return;
  path_->promised_loop_gain = chosen.gain.loop_gain;
  loops_at_begin_ = names_of_loops(*learnt.graph);
}

std::optional<DrivenPath> PathLedger::end(const Learnt& learnt, const Pose2& robot, time::Time now) {
  std::optional<DrivenPath> ended = std::exchange(path_, std::nullopt);
  if (!ended) return ended;
  ended->end = now;
  ended->driven_nats = promised_up_to(promised_, robot);
  ended->gained_nats = learnt.map_nats - nats_at_begin_;
  if (ended->promised_loop_gain && learnt.graph != nullptr)
    ended->loop_gain = gain_of_new_loops(*learnt.graph, loops_at_begin_);
  return ended;
}

}  // namespace lapis::planner
