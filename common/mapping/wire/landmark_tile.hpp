#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/model/voxel_index.hpp"

namespace lapis::mapping {

/// A tile of landmarks never takes more bytes than this on the wire.
inline constexpr std::size_t kMaxLandmarkTileBytes = std::size_t{1} << 20;
/// Landmarks whose distance from the map's origin along an axis exceeds this are in no tile [m].
inline constexpr double kMaxLandmarkCoordinate_m = 10'000.0;

/// slam's landmarks in the cube [index * edge, (index + 1) * edge) of the map frame, which is half open.
struct LandmarkTile {
  TileIndex index;
  std::uint64_t graph_version = 0;           ///< version of the pose graph at which the tile last changed
  std::uint32_t omitted = 0;                 ///< number of landmarks that did not fit into kMaxLandmarkTileBytes
  std::vector<std::uint32_t> ids;            ///< ascending, unique in an epoch
  std::vector<Eigen::Vector3f> positions_m;  ///< in the map frame, one per id; rounding error |coordinate| * 2^-24
  /// Key-frames that observe landmark i are observers[observer_ends[i - 1]] to observers[observer_ends[i] - 1],
  /// starting at 0 for i = 0: at least one, in ascending order.
  std::vector<std::uint32_t> observer_ends;
  std::vector<std::uint32_t> observers;

  bool operator==(const LandmarkTile&) const = default;
};

/// The reason why a received tile is not valid, one of a fixed set of texts; empty when it is valid.
std::string fault_of(const LandmarkTile& tile);

/// State of a version of slam's landmarks; slam publishes it after the tiles of that version.
struct LandmarkState {
  std::int64_t session = 0;         ///< grows when slam starts a new map
  std::int64_t epoch = 0;           ///< grows then, too, and when a restarted slam publishes all tiles again
  std::uint64_t graph_version = 0;  ///< of the pose graph to whose poses the positions belong
  std::uint32_t tiles = 0;          ///< tiles that exist in this version, empty ones included
  std::uint64_t checksum = 0;       ///< sum of tile_hash(index, graph version), modulo 2^64
  double tile_edge_m = 0.0;
  /// A landmark that has moved no further than this since its tile was sent keeps its position in the tile.
  double tolerance_m = 0.0;
};

/// Bytes on the wire, at most: two words and a position for each landmark, a word for each observer; the constant
/// covers the other fields.
constexpr std::size_t landmark_tile_bytes(std::size_t landmarks, std::size_t observers) {
  return 96 + landmarks * (2 * sizeof(std::uint32_t) + 3 * sizeof(float)) + observers * sizeof(std::uint32_t);
}

/// Tile of a position whose coordinates are at most kMaxLandmarkCoordinate_m.
inline TileIndex landmark_tile_of(const Eigen::Vector3f& p_map, double edge_m) {
  const auto cell = [edge_m](float x) {
    return static_cast<std::int32_t>(std::floor(static_cast<double>(x) / edge_m));
  };
  return {cell(p_map.x()), cell(p_map.y()), cell(p_map.z())};
}

}  // namespace lapis::mapping
