#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "common/mapping/wire/landmark_tile.hpp"
#include "common/mapping/wire/tile_versions.hpp"

namespace lapis::mapping {

/// Mirror of slam's landmarks in another process. Tiles and states may arrive in any order, repeatedly, late, and
/// across a restart of slam. tiles() are always one complete version: the newest one whose tiles were all present at
/// the same time.
class LandmarkMirror {
 public:
  /// Returns false, and changes nothing, when the epoch is over or this version of the tile or a newer one is known
  /// already.
  bool apply_tile(std::int64_t epoch, LandmarkTile tile);
  void apply_state(const LandmarkState& state);

  /// True when tiles() are the newest announced version.
  bool is_consistent() const { return served_ && newest_ && is_same(*served_, *newest_); }
  /// Tiles of the last consistent version; empty before the first.
  const std::map<TileIndex, LandmarkTile>& tiles() const { return tiles_; }
  /// State of tiles(); nothing before the first consistent version.
  const std::optional<LandmarkState>& state() const { return served_; }

 private:
  static bool is_same(const LandmarkState& a, const LandmarkState& b) {
    return a.epoch == b.epoch && a.graph_version == b.graph_version;
  }
  /// Returns false when `epoch` is over; a newer epoch starts without tiles.
  bool enter_epoch(std::int64_t epoch);
  void serve_if_complete();

  std::optional<std::int64_t> epoch_;
  TileVersions versions_;                      // newest received, of epoch_
  std::map<TileIndex, LandmarkTile> pending_;  // received, not yet in tiles_
  std::optional<LandmarkState> newest_;
  std::optional<LandmarkState> served_;
  std::map<TileIndex, LandmarkTile> tiles_;
};

}  // namespace lapis::mapping
