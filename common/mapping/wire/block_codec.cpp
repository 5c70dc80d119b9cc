#include "common/mapping/wire/block_codec.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "common/mapping/model/frame_votes.hpp"

namespace lapis::mapping {
namespace {

constexpr std::uint64_t kEmpty = 0, kUniform = 1, kVoxels = 2, kWholeVotes = 4;

bool has_only_whole_votes(const VoxelBlock& block) {
  VoxelCounts counts;
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    block.read(offset, counts);
    std::uint32_t parts = counts.misses;
    for (const ClassCount& hit : counts.hits) parts |= hit.count;
    if (parts % kOneVote != 0) return false;
  }
  return true;
}

void write_voxels(const VoxelBlock& block, std::uint32_t unit, files::ByteWriter& out) {
  VoxelCounts counts;
  for (int offset = 0; offset < kBlockVoxels;) {
    if (!block.has_hits(offset)) {
      int end = offset + 1;
      while (end < kBlockVoxels && block.misses(end) == block.misses(offset) && !block.has_hits(end)) ++end;
      out.varint(static_cast<std::uint64_t>(end - offset) << 1);
      out.varint(block.misses(offset) / unit);
      offset = end;
      continue;
    }
    block.read(offset++, counts);
    out.varint(counts.hits.size() << 1 | 1u);
    out.varint(counts.misses / unit);
    for (const ClassCount& hit : counts.hits) {
      out.varint(hit.label);
      out.varint(hit.count / unit);
    }
  }
}

std::uint32_t read_count(files::ByteReader& in, std::uint32_t unit) {
  const std::uint64_t value = in.varint();
  if (value > std::numeric_limits<std::uint32_t>::max() / unit) in.fail();
  return static_cast<std::uint32_t>(value) * unit;
}

void read_hits(files::ByteReader& in, std::uint64_t classes, std::uint32_t unit, int offset,
               std::vector<HitVote>& hits) {
  if (classes == 0) in.fail();
  std::int32_t previous = -1;
  for (std::uint64_t i = 0; i < classes && in.is_good(); ++i) {
    const std::uint64_t label = in.varint();
    const std::uint32_t count = read_count(in, unit);
    if (label > 0xffff || static_cast<std::int32_t>(label) <= previous || count == 0) return in.fail();
    previous = static_cast<std::int32_t>(label);
    hits.push_back({static_cast<std::uint16_t>(offset), static_cast<std::uint16_t>(label), count});
  }
}

VoxelBlock read_voxels(files::ByteReader& reader, std::uint32_t unit) {
  files::ByteReader in = reader;  // a local copy stays in registers: late joiners wait for this loop
  std::array<std::uint32_t, kBlockVoxels> misses{};
  thread_local std::vector<HitVote> hits;
  hits.clear();
  for (int offset = 0; offset < kBlockVoxels && in.is_good();) {
    const std::uint64_t head = in.varint();
    const std::uint64_t run = head & 1u ? 1 : head >> 1;
    if (run == 0 || run > static_cast<std::uint64_t>(kBlockVoxels - offset)) {
      in.fail();
      break;
    }
    std::fill_n(misses.begin() + offset, run, read_count(in, unit));
    if (head & 1u) read_hits(in, head >> 1, unit, offset, hits);
    offset += static_cast<int>(run);
  }
  reader = in;
  return {misses, hits};
}

}  // namespace

void write_block(const VoxelBlock* block, files::ByteWriter& out) {
  if (block == nullptr || block->is_empty()) return out.varint(kEmpty);
  if (block->is_uniform()) return out.varint(static_cast<std::uint64_t>(block->misses(0)) << 2 | kUniform);
  const bool is_whole = has_only_whole_votes(*block);
  out.varint(kVoxels | (is_whole ? kWholeVotes : 0));
  write_voxels(*block, is_whole ? kOneVote : 1, out);
}

VoxelBlock read_block(files::ByteReader& in) {
  VoxelBlock block;
  const std::uint64_t word = in.varint();
  if ((word & 3u) == kUniform) {
    const std::uint64_t misses = word >> 2;
    if (misses == 0 || misses > std::numeric_limits<std::uint32_t>::max()) in.fail();
    block = VoxelBlock(static_cast<std::uint32_t>(misses));
  } else if (word == kVoxels || word == (kVoxels | kWholeVotes)) {
    block = read_voxels(in, word & kWholeVotes ? kOneVote : 1);
  } else if (word != kEmpty) {
    in.fail();
  }
  return block;
}

}  // namespace lapis::mapping
