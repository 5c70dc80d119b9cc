#include "planner/core/exploration/path_ledger.hpp"

#include <limits>
#include <utility>

namespace lapis::planner {
namespace {

/// Of the views up to the one nearest to the robot; of several at one place, the last.
double promised_up_to(const std::vector<PromisedView>& promised, const Eigen::Vector2d& robot_map) {
  double nats = 0.0, nearest_m = std::numeric_limits<double>::infinity();
  for (const PromisedView& view : promised) {
    const double off_m = (view.p_map - robot_map).norm();
    if (off_m > nearest_m) continue;
    nearest_m = off_m;
    nats = view.nats;
  }
  return nats;
}

}  // namespace

std::optional<DrivenPath> PathLedger::note(const Decision* decision, double map_nats, const Eigen::Vector2d& robot_map,
                                           time::Time now) {
  const bool continues = path_ && decision != nullptr &&
                         (decision->candidates[*decision->chosen].target_map - target_map_).norm() <= radius_m_;
  if (continues) return std::nullopt;
  const auto ended = end(map_nats, robot_map, now);
  if (decision != nullptr) begin(*decision, map_nats, now);
  return ended;
}

void PathLedger::begin(const Decision& decision, double map_nats, time::Time now) {
  const Candidate& chosen = decision.candidates[*decision.chosen];
  path_.emplace();
  path_->begin = now;
  path_->kind = chosen.kind;
  path_->cost_m = chosen.value.cost_m;
  path_->promised_nats = chosen.value.path_information;
  promised_ = decision.promised;
  target_map_ = chosen.target_map;
  nats_at_begin_ = map_nats;
}

std::optional<DrivenPath> PathLedger::end(double map_nats, const Eigen::Vector2d& robot_map, time::Time now) {
  std::optional<DrivenPath> ended = std::exchange(path_, std::nullopt);
  if (!ended) return ended;
  ended->end = now;
  ended->driven_nats = promised_up_to(promised_, robot_map);
  ended->gained_nats = map_nats - nats_at_begin_;
  return ended;
}

}  // namespace lapis::planner
