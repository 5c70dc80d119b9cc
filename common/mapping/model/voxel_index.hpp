#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>

namespace lapis::mapping {

/// Voxels along one edge of a block; blocks are the unit of storage and of the tile format.
inline constexpr int kBlockEdge = 8;
/// Voxels in a block.
inline constexpr int kBlockVoxels = kBlockEdge * kBlockEdge * kBlockEdge;

/// Integer cell of a regular grid whose corner (0, 0, 0) is the origin of the map frame. Ordered by z, then y, then x,
/// which is the order in every file and message, so that equal maps give equal bytes.
template <class Tag>
struct GridIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int32_t z = 0;

  constexpr bool operator==(const GridIndex&) const = default;
  constexpr std::strong_ordering operator<=>(const GridIndex& other) const {
    if (const auto by_z = z <=> other.z; by_z != 0) return by_z;
    if (const auto by_y = y <=> other.y; by_y != 0) return by_y;
    return x <=> other.x;
  }
};

/// Voxel (x, y, z) covers [x*r, (x+1)*r) and so on, in the map frame, r = resolution.
using VoxelIndex = GridIndex<struct VoxelTag>;
/// Block of 8x8x8 voxels: block (x, y, z) holds voxels 8x..8x+7 and so on.
using BlockIndex = GridIndex<struct BlockTag>;
/// Tile: a cube of whole blocks, see tile_codec.hpp.
using TileIndex = GridIndex<struct TileTag>;

/// Quotient rounded towards minus infinity; `divisor` is positive.
constexpr std::int32_t floor_divide(std::int32_t value, std::int32_t divisor) {
  const std::int32_t quotient = value / divisor;
  return value % divisor < 0 ? quotient - 1 : quotient;
}

constexpr BlockIndex block_of(const VoxelIndex& v) {
  return {floor_divide(v.x, kBlockEdge), floor_divide(v.y, kBlockEdge), floor_divide(v.z, kBlockEdge)};
}

/// Position of a voxel inside its block: x + 8 y + 64 z, in [0, 512).
constexpr int offset_in_block(const VoxelIndex& v) {
  const auto low = [](std::int32_t i) { return static_cast<int>(static_cast<std::uint32_t>(i) & 7u); };
  return low(v.x) + kBlockEdge * low(v.y) + kBlockEdge * kBlockEdge * low(v.z);
}

constexpr VoxelIndex voxel_at(const BlockIndex& block, int offset) {
  return {block.x * kBlockEdge + (offset & 7), block.y * kBlockEdge + ((offset >> 3) & 7),
          block.z * kBlockEdge + (offset >> 6)};
}

/// Mixes the bits of a 64-bit word (finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t mix_bits(std::uint64_t h) {
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ull;
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebull;
  return h ^ (h >> 31);
}

struct GridIndexHash {
  template <class Tag>
  std::size_t operator()(const GridIndex<Tag>& i) const {
    const auto word = [](std::int32_t v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
    return static_cast<std::size_t>(mix_bits(word(i.x) * 0x9e3779b97f4a7c15ull + (word(i.y) << 32 | word(i.z))));
  }
};

}  // namespace lapis::mapping
