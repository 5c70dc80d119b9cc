#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/mapping/model/voxel_map.hpp"

namespace lapis::mapping {

/// A tile never takes more bytes than this on the wire.
inline constexpr std::size_t kMaxTileBytes = std::size_t{1} << 20;
/// Default edge of a tile [m].
inline constexpr double kDefaultTileEdge_m = 0.8;
inline constexpr int kMaxBlocksPerTileEdge = 16;

/// A tile's edge is the smallest whole number of blocks that is at least `tile_edge_m`: the number of tiles depends on
/// the volume and hardly on the resolution, while a block is never shared by two tiles. At 0.25 m, a single block has
/// an edge of 2 m. Throws std::runtime_error when the result exceeds kMaxBlocksPerTileEdge.
int blocks_per_tile_edge(double resolution_m, double tile_edge_m);

TileIndex tile_of(const BlockIndex& block, int blocks_per_edge);
/// Blocks of a tile in canonical order (z, y, x).
std::vector<BlockIndex> blocks_of(const TileIndex& tile, int blocks_per_edge);

struct DecodedTile {
  double resolution_m = 0.0;
  int blocks_per_edge = 0;
  std::vector<std::pair<BlockIndex, VoxelBlock>> blocks;  ///< only those that are not empty
};

/// Bytes of the tile's counts. Layout (little-endian): 'L', format version 1, blocks per edge, flags (1: the body is
/// one zstd frame), resolution (f64), then the body: every block of the tile in the format of block_codec.hpp, in
/// canonical order. The body is compressed only when it is large, because most tiles are small and must stay cheap.
/// Returns nothing when the tile exceeds kMaxTileBytes all the same, which takes several classes in nearly every one of
/// 64,000 voxels.
std::optional<std::vector<std::uint8_t>> encode_tile(const VoxelMap& map, const TileIndex& tile, int blocks_per_edge);

/// Tiles farther than this from the origin of the map frame are rejected [m].
inline constexpr double kMaxReach_m = 1000.0;

/// Inverse of encode_tile for the tile at `index`. Returns nothing when the bytes are not a well-formed tile, or when
/// the tile is beyond kMaxReach_m: any input is safe.
std::optional<DecodedTile> decode_tile(std::span<const std::uint8_t> bytes, const TileIndex& index);

/// Hash of a tile at a map version; the checksum of a map state is the sum over its tiles modulo 2^64.
std::uint64_t tile_hash(const TileIndex& tile, std::uint64_t version);

}  // namespace lapis::mapping
