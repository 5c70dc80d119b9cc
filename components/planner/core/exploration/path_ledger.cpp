#include "planner/core/exploration/path_ledger.hpp"

#include <utility>

namespace lapis::planner {

std::optional<DrivenPath> PathLedger::note(const Candidate* chosen, double map_nats, time::Time now) {
  const bool continues = path_ && chosen != nullptr && (chosen->target_map - target_map_).norm() <= radius_m_;
  std::optional<DrivenPath> ended;
  if (!continues) {
    ended = std::exchange(path_, std::nullopt);
    if (ended) {
      ended->end = now;
      ended->gained_nats = map_nats - nats_at_begin_;
    }
  }
  if (chosen == nullptr) return ended;
  if (!path_) {
    path_.emplace();
    path_->begin = now;
    path_->kind = chosen->kind;
    path_->cost_m = chosen->value.cost_m;
    path_->promised_nats = chosen->value.path_information;
    target_map_ = chosen->target_map;
    nats_at_begin_ = map_nats;
  }
  path_->rest_m = chosen->value.cost_m;
  path_->rest_nats = chosen->value.path_information;
  return ended;
}

}  // namespace lapis::planner
