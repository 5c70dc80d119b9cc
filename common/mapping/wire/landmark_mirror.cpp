#include "common/mapping/wire/landmark_mirror.hpp"

#include <utility>

namespace lapis::mapping {

bool LandmarkMirror::enter_session(std::int64_t session) {
  if (session_ && session < *session_) return false;
  if (!session_ || session > *session_) {
    session_ = session;
    versions_.clear();
    pending_.clear();
  }
  return true;
}

bool LandmarkMirror::apply_tile(std::int64_t session, LandmarkTile tile) {
  if (!enter_session(session) || !versions_.set(tile.index, tile.graph_version)) return false;
  const TileIndex index = tile.index;
  pending_.insert_or_assign(index, std::move(tile));
  serve_if_complete();
  return true;
}

void LandmarkMirror::apply_state(const LandmarkState& state) {
  if (!enter_session(state.session)) return;
  if (newest_ && newest_->session == state.session && newest_->graph_version >= state.graph_version) return;
  newest_ = state;
  serve_if_complete();
}

void LandmarkMirror::serve_if_complete() {
  if (!newest_ || newest_->session != *session_ || is_consistent()) return;
  if (newest_->tiles != versions_.size() || newest_->checksum != versions_.checksum()) return;
  if (!served_ || served_->session != newest_->session) tiles_.clear();
  for (auto& [index, tile] : pending_) tiles_.insert_or_assign(index, std::move(tile));
  pending_.clear();
  served_ = newest_;
}

}  // namespace lapis::mapping
