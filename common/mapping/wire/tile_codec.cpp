#include "common/mapping/wire/tile_codec.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/files/zstd_codec.hpp"
#include "common/mapping/wire/block_codec.hpp"

namespace lapis::mapping {
namespace {

constexpr std::size_t kHeaderBytes = 12;  // four single bytes and the resolution
constexpr std::uint8_t kTileMagic = 'L', kTileFormatVersion = 1, kCompressed = 1;
constexpr std::size_t kCompressAbove = std::size_t{256} << 10;
constexpr std::size_t kMaxBodyBytes = std::size_t{64} << 20;
constexpr int kTileCompressionLevel = 1;

void read_blocks(files::ByteReader& in, const TileIndex& index, DecodedTile& tile) {
  const std::vector<BlockIndex> indices = blocks_of(index, tile.blocks_per_edge);
  tile.blocks.reserve(indices.size());
  for (const BlockIndex& block_index : indices) {
    VoxelBlock block = read_block(in);
    if (!in.is_good()) return;
    if (!block.is_empty()) tile.blocks.emplace_back(block_index, std::move(block));
  }
  if (in.remaining() > 0) in.fail();
}

/// A distant tile would make a receiver that stores the map in an array of its extent allocate unbounded memory.
bool is_within_reach(const TileIndex& index, const DecodedTile& tile) {
  const double edge_m = tile.blocks_per_edge * kBlockEdge * tile.resolution_m;
  const auto is_near = [&](std::int32_t i) { return std::abs(static_cast<double>(i)) * edge_m <= kMaxReach_m; };
  return is_near(index.x) && is_near(index.y) && is_near(index.z);
}

}  // namespace

int blocks_per_tile_edge(double resolution_m, double tile_edge_m) {
  const double blocks = tile_edge_m / (resolution_m * kBlockEdge);
  // The small tolerance makes a tile of 0.8 m at 0.1 m one block in spite of rounding.
  const int count = std::max(1, static_cast<int>(std::ceil(blocks - 1e-6)));
  if (!(blocks <= kMaxBlocksPerTileEdge + 1e-6))
    throw std::runtime_error("tile edge is more than 16 blocks of 8 voxels; choose a smaller tile edge");
  return count;
}

TileIndex tile_of(const BlockIndex& block, int blocks_per_edge) {
  return {floor_divide(block.x, blocks_per_edge), floor_divide(block.y, blocks_per_edge),
          floor_divide(block.z, blocks_per_edge)};
}

std::vector<BlockIndex> blocks_of(const TileIndex& tile, int blocks_per_edge) {
  // Unsigned arithmetic, because an index from the wire may have any value and must not overflow.
  const auto first = [blocks_per_edge](std::int32_t i) {
    return static_cast<std::uint32_t>(i) * static_cast<std::uint32_t>(blocks_per_edge);
  };
  const auto edge = static_cast<std::uint32_t>(blocks_per_edge);
  std::vector<BlockIndex> blocks;
  for (std::uint32_t z = 0; z < edge; ++z)
    for (std::uint32_t y = 0; y < edge; ++y)
      for (std::uint32_t x = 0; x < edge; ++x)
        blocks.push_back({static_cast<std::int32_t>(first(tile.x) + x), static_cast<std::int32_t>(first(tile.y) + y),
                          static_cast<std::int32_t>(first(tile.z) + z)});
  return blocks;
}

std::optional<std::vector<std::uint8_t>> encode_tile(const VoxelMap& map, const TileIndex& tile, int blocks_per_edge) {
  files::ByteWriter body;
  for (const BlockIndex& block : blocks_of(tile, blocks_per_edge)) write_block(map.find(block), body);
  const bool is_large = body.bytes().size() > kCompressAbove;

  files::ByteWriter out;
  out.reserve(kHeaderBytes + body.bytes().size());
  out.u8(kTileMagic);
  out.u8(kTileFormatVersion);
  out.u8(static_cast<std::uint8_t>(blocks_per_edge));
  out.u8(is_large ? kCompressed : 0);
  out.f64(map.resolution_m());
  out.raw(is_large ? files::zstd_compress(body.bytes(), kTileCompressionLevel) : body.bytes());
  if (out.bytes().size() > kMaxTileBytes) return std::nullopt;
  return out.take();
}

std::optional<DecodedTile> decode_tile(std::span<const std::uint8_t> bytes, const TileIndex& index) {
  if (bytes.size() > kMaxTileBytes) return std::nullopt;
  files::ByteReader in(bytes);
  DecodedTile tile;
  const bool is_known = in.u8() == kTileMagic && in.u8() == kTileFormatVersion;
  tile.blocks_per_edge = in.u8();
  const std::uint8_t flags = in.u8();
  tile.resolution_m = in.f64();
  const bool is_sane = tile.blocks_per_edge >= 1 && tile.blocks_per_edge <= kMaxBlocksPerTileEdge &&
                       flags <= kCompressed && tile.resolution_m >= kMinResolution_m &&
                       tile.resolution_m <= kMaxResolution_m;
  if (!in.is_good() || !is_known || !is_sane || !is_within_reach(index, tile)) return std::nullopt;
  if (flags & kCompressed) {
    const auto body = files::zstd_decompress(in.raw(in.remaining()), kMaxBodyBytes);
    if (!body) return std::nullopt;
    files::ByteReader unpacked(*body);
    read_blocks(unpacked, index, tile);
    if (!unpacked.is_good()) return std::nullopt;
  } else {
    read_blocks(in, index, tile);
    if (!in.is_good()) return std::nullopt;
  }
  return tile;
}

std::uint64_t tile_hash(const TileIndex& tile, std::uint64_t version) {
  const auto word = [](std::int32_t v) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)); };
  std::uint64_t h = mix_bits(version + 0x9e3779b97f4a7c15ull);
  h = mix_bits(h ^ word(tile.x) ^ word(tile.y) << 32);
  return mix_bits(h + word(tile.z) * 0x9e3779b97f4a7c15ull);
}

}  // namespace lapis::mapping
