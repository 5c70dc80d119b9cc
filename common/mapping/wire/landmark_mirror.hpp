#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/mapping/wire/landmark_tile.hpp"
#include "common/mapping/wire/tile_versions.hpp"

namespace lapis::mapping {

/// Mirror of slam's landmarks in another process. Tiles and states may come in any order, repeated, late, and across a
/// restart of slam; tiles() are always one version as a whole: the newest whose tiles were all there together.
class LandmarkMirror {
 public:
  /// False, and nothing changes, when the session is over or the tile is known as new as that or newer.
  bool apply_tile(std::int64_t session, LandmarkTile tile);
  void apply_state(const LandmarkState& state);

  /// True when tiles() are the newest announced version.
  bool is_consistent() const { return served_ && newest_ && is_same(*served_, *newest_); }
  /// The last consistent version; empty before the first.
  const std::map<TileIndex, LandmarkTile>& tiles() const { return tiles_; }
  /// State that tiles() belong to; nothing before the first.
  const std::optional<LandmarkState>& state() const { return served_; }

 private:
  static bool is_same(const LandmarkState& a, const LandmarkState& b) {
    return a.session == b.session && a.graph_version == b.graph_version;
  }
  /// False when `session` is over; a newer one starts from nothing.
  bool enter_session(std::int64_t session);
  void serve_if_complete();

  std::optional<std::int64_t> session_;
  TileVersions versions_;                      // newest received, of session_
  std::map<TileIndex, LandmarkTile> pending_;  // received, not yet in tiles_
  std::optional<LandmarkState> newest_;
  std::optional<LandmarkState> served_;
  std::map<TileIndex, LandmarkTile> tiles_;
};

}  // namespace lapis::mapping
