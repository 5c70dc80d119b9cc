#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "common/mapping/model/voxel_map.hpp"
#include "common/mapping/wire/tile_codec.hpp"
#include "common/mapping/wire/tile_versions.hpp"

namespace lapis::mapping {

/// State of a version of the mapper's map; the mapper publishes it after the tiles of that version.
struct MapState {
  std::int64_t epoch = 0;  ///< grows when a mapper starts a new map
  std::uint64_t version = 0;
  std::uint32_t tiles = 0;     ///< tiles that exist in this version
  std::uint64_t checksum = 0;  ///< sum of tile_hash(index, version that last changed it), modulo 2^64
  double resolution_m = 0.0;
  std::int64_t session = 0;  ///< session of slam, whose map frame the map uses
  /// Number of frames that are still in the map more than a voxel away from their pose in the newest graph.
  std::uint64_t frames_off = 0;
};

enum class TileResult { kAccepted, kOutdated, kDamaged };

/// Mirror of the mapper's map in another process. Tiles and states may arrive in any order, repeatedly, late, and
/// across a restart of the mapper. map() is always one complete version of the mapper's map: the newest one whose tiles
/// were all present at the same time.
class MapMirror {
 public:
  TileResult apply_tile(std::int64_t epoch, const TileIndex& index, std::uint64_t version,
                        std::span<const std::uint8_t> bytes);
  void apply_state(const MapState& state);

  /// True when map() is the newest announced version.
  bool is_consistent() const { return served_ && newest_ && is_same(*served_, *newest_); }
  /// The last consistent version; null before the first.
  const VoxelMap* map() const { return map_ ? &*map_ : nullptr; }
  /// State of map(); nothing before the first consistent version.
  const std::optional<MapState>& state() const { return served_; }
  /// Blocks whose content in map() has changed since the last call, in canonical order. Removed blocks are among them.
  std::vector<BlockIndex> take_changed_blocks();
  /// Newest announced state; nothing before the first.
  const std::optional<MapState>& newest_state() const { return newest_; }

 private:
  struct PendingTile {
    int blocks_per_edge;
    std::vector<std::pair<BlockIndex, VoxelBlock>> blocks;
  };

  static bool is_same(const MapState& a, const MapState& b) { return a.epoch == b.epoch && a.version == b.version; }
  /// Returns false when `epoch` is over; a newer epoch starts without tiles.
  bool enter_epoch(std::int64_t epoch);
  void serve_if_complete();
  void replace_map(double resolution_m);
  void apply(const TileIndex& index, PendingTile& tile);

  std::optional<std::int64_t> epoch_;
  TileVersions versions_;                     ///< newest received, of epoch_
  std::map<TileIndex, PendingTile> pending_;  ///< received, not yet in map_
  std::optional<MapState> newest_;
  std::optional<MapState> served_;
  std::optional<VoxelMap> map_;
  std::set<BlockIndex> changed_;
};

}  // namespace lapis::mapping
