#include "common/mapping/wire/map_mirror.hpp"

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
  if (!served_ || served_->epoch != newest_->epoch) replace_map(newest_->resolution_m);
  for (auto& [index, tile] : pending_) apply(index, tile);
  pending_.clear();
  served_ = newest_;
}

void MapMirror::replace_map(double resolution_m) {
  if (map_) {
    for (const BlockIndex& block : map_->sorted_blocks()) changed_.insert(block);
  }
  map_.emplace(resolution_m);
}

void MapMirror::apply(const TileIndex& index, PendingTile& tile) {
  auto next = tile.blocks.begin();  // sorted in the same order as blocks_of
  for (const BlockIndex& block : blocks_of(index, tile.blocks_per_edge)) {
    const VoxelBlock* before = map_->find(block);
    const bool is_there = next != tile.blocks.end() && next->first == block;
    if (is_there ? before == nullptr || !(*before == next->second) : before != nullptr) changed_.insert(block);
    if (is_there) {
      map_->set_block(block, std::move(next++->second));
    } else {
      map_->erase_block(block);
    }
  }
}

std::vector<BlockIndex> MapMirror::take_changed_blocks() {
  std::vector<BlockIndex> changed(changed_.begin(), changed_.end());
  changed_.clear();
  return changed;
}

}  // namespace lapis::mapping
