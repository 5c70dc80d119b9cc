#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/mapping/wire/landmark_tile.hpp"
#include "common/mapping/wire/tile_versions.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

struct LandmarkTileConfig {
  double edge_m = 1.6;        ///< edge of a tile [0.1, 100]
  double tolerance_m = 0.01;  ///< a landmark that has moved by no more keeps the position that was sent [0, 1]
  std::size_t max_tile_bytes = mapping::kMaxLandmarkTileBytes;
};

/// The landmarks of a map as other processes have them: in cubic tiles, each with the graph version at which it last
/// changed. Tiles that are the same as before, or nearly, are not made again.
class LandmarkTiles {
 public:
  explicit LandmarkTiles(const LandmarkTileConfig& config) : config_(config) {}

  /// Brings the tiles up to date with the map at `graph_version`, which grows from call to call. Returns the tiles that
  /// differ from those returned before, ascending. The map never has fewer landmarks than at the previous call. A tile
  /// that has lost its last landmark is returned empty and continues to exist. Afterwards every landmark with
  /// observations is in exactly one tile: that of the position that was sent for it, which is at most `tolerance_m`
  /// from its present one. Positions that are not finite or beyond mapping::kMaxLandmarkCoordinate_m are left out, and
  /// so are the landmarks of sub-maps, until these are joined to the map.
  std::vector<mapping::LandmarkTile> update(const Map& map, std::uint64_t graph_version);
  /// State after the last update; the caller sets its session and epoch.
  mapping::LandmarkState state() const;

 private:
  // A landmark as it was sent.
  struct Sent {
    bool is_in_tile = false;
    mapping::TileIndex tile;
    Eigen::Vector3f p_map = Eigen::Vector3f::Zero();
    std::uint64_t observers = 0;  // sum of the hashes of its key-frames' ids
  };
  // Landmarks of each tile, ascending.
  using Members = std::unordered_map<mapping::TileIndex, std::vector<LandmarkId>, mapping::GridIndexHash>;

  static Sent as_now(const Map& map, const Landmark& landmark);
  bool is_same(const Sent& a, const Sent& b) const;
  Members follow(const Map& map);
  mapping::LandmarkTile make_tile(const Map& map, const mapping::TileIndex& index,
                                  const std::vector<LandmarkId>& members) const;

  LandmarkTileConfig config_;
  std::vector<Sent> sent_;  // by id
  mapping::TileVersions versions_;
  std::uint64_t graph_version_ = 0;
};

}  // namespace lapis::slam
