#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mapping/model/voxel_index.hpp"

namespace lapis::mapping {

/// One vote in fixed point. Every contribution is a whole number of these 1/256 votes, so sums are exact in any order.
inline constexpr std::uint32_t kOneVote = 256;

/// One bit per voxel of a block: bit offset % 64 of word offset / 64.
using BlockMask = std::array<std::uint64_t, kBlockVoxels / 64>;

/// A vote for `label` (0 = unlabelled) in one voxel of a block.
struct HitVote {
  std::uint16_t offset = 0;  ///< offset_in_block
  std::uint16_t label = 0;
  std::uint32_t weight = kOneVote;  ///< [1/256 vote]
  bool operator==(const HitVote&) const = default;
};

/// Votes of one frame for one block. A voxel is in `misses` (weight kOneVote) or in the hits, never in both, and the
/// total weight of its hits is at most kOneVote.
struct BlockVotes {
  BlockIndex block;
  BlockMask misses{};
  std::uint32_t hits_begin = 0;  ///< range in FrameVotes::hits, sorted by offset, then label
  std::uint32_t hits_end = 0;
  bool operator==(const BlockVotes&) const = default;
};

/// Votes of one frame for the map: at most one miss or one hit vote per voxel; a hit vote may be split between a class
/// and "unlabelled". Sorted by block.
struct FrameVotes {
  std::vector<BlockVotes> blocks;
  std::vector<HitVote> hits;

  std::span<const HitVote> hits_of(const BlockVotes& block) const {
    return std::span(hits).subspan(block.hits_begin, block.hits_end - block.hits_begin);
  }
  std::size_t hit_count() const { return hits.size(); }
  std::size_t miss_count() const {
    std::size_t count = 0;
    for (const BlockVotes& votes : blocks)
      for (const std::uint64_t word : votes.misses) count += static_cast<std::size_t>(std::popcount(word));
    return count;
  }
  bool operator==(const FrameVotes&) const = default;
};

/// Removes from both the votes that they have in common, so that only their difference remains: to subtract `a` from a
/// map and add `b` has the same effect before and after the call.
void drop_common(FrameVotes& a, FrameVotes& b);

}  // namespace lapis::mapping
