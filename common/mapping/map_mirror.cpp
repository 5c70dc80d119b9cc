#include "common/mapping/map_mirror.hpp"

namespace lapis::mapping {

bool MapMirror::enter_epoch(std::int64_t epoch) {
  if (epoch_ && epoch < *epoch_) return false;
  if (!epoch_ || epoch > *epoch_) {
    epoch_ = epoch;
    versions_.clear();
    pending_.clear();
  }
  return true;
}

TileResult MapMirror::apply_tile(std::int64_t epoch, const TileIndex& index, std::uint64_t version,
                                 std::span<const std::uint8_t> bytes) {
  if (epoch_ && epoch < *epoch_) return TileResult::kOutdated;
  auto tile = decode_tile(bytes, index);
  if (!tile) return TileResult::kDamaged;
  enter_epoch(epoch);
  if (!versions_.set(index, version)) return TileResult::kOutdated;
  pending_.insert_or_assign(index, PendingTile{tile->blocks_per_edge, std::move(tile->blocks)});
  serve_if_complete();
  return TileResult::kAccepted;
}

void MapMirror::apply_state(const MapState& state) {
  if (!enter_epoch(state.epoch)) return;
  if (newest_ && newest_->epoch == state.epoch && newest_->version >= state.version) return;
  newest_ = state;
  serve_if_complete();
}

void MapMirror::serve_if_complete() {
  if (!newest_ || newest_->epoch != *epoch_ || is_consistent()) return;
  if (newest_->tiles != versions_.size() || newest_->checksum != versions_.checksum()) return;
  if (!(newest_->resolution_m >= kMinResolution_m && newest_->resolution_m <= kMaxResolution_m)) return;
  if (!served_ || served_->epoch != newest_->epoch) map_.emplace(newest_->resolution_m);
  for (auto& [index, tile] : pending_) {
    for (const BlockIndex& block : blocks_of(index, tile.blocks_per_edge)) map_->erase_block(block);
    for (auto& [block_index, block] : tile.blocks) map_->set_block(block_index, std::move(block));
  }
  pending_.clear();
  served_ = newest_;
}

}  // namespace lapis::mapping
