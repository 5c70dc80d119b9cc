#include "common/mapping/wire/landmark_mirror.hpp"

#include <utility>

namespace lapis::mapping {

bool LandmarkMirror::enter_epoch(std::int64_t epoch) {
  if (epoch_ && epoch < *epoch_) return false;
  if (!epoch_ || epoch > *epoch_) {
    epoch_ = epoch;
    versions_.clear();
    pending_.clear();
  }
  return true;
}

bool LandmarkMirror::apply_tile(std::int64_t epoch, LandmarkTile tile) {
  if (!enter_epoch(epoch) || !versions_.set(tile.index, tile.graph_version)) return false;
  const TileIndex index = tile.index;
  pending_.insert_or_assign(index, std::move(tile));
  serve_if_complete();
  return true;
}

void LandmarkMirror::apply_state(const LandmarkState& state) {
  if (!enter_epoch(state.epoch)) return;
  if (newest_ && newest_->epoch == state.epoch && newest_->graph_version >= state.graph_version) return;
  newest_ = state;
  serve_if_complete();
}

void LandmarkMirror::serve_if_complete() {
  if (!newest_ || newest_->epoch != *epoch_ || is_consistent()) return;
  if (newest_->tiles != versions_.size() || newest_->checksum != versions_.checksum()) return;
  if (!served_ || served_->epoch != newest_->epoch) tiles_.clear();
  for (auto& [index, tile] : pending_) tiles_.insert_or_assign(index, std::move(tile));
  pending_.clear();
  served_ = newest_;
}

}  // namespace lapis::mapping
