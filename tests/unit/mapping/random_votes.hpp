#pragma once

#include <map>
#include <random>

#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::mapping::test {

/// Random votes in a small cube of blocks around the origin; many voxels are met again and again by several classes.
inline FrameVotes random_votes(std::mt19937& random, std::uint32_t weight_step = kOneVote, int classes = 5) {
  std::map<BlockIndex, std::map<int, HitVote>> hits;
  std::map<BlockIndex, std::vector<int>> misses;
  const auto number = [&random](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
  for (int i = 0; i < 200; ++i) {
    const BlockIndex block{number(-2, 1), number(-1, 1), number(0, 1)};
    const int offset = number(0, kBlockVoxels - 1) / 7 * 7;  // few distinct voxels
    if (number(0, 2) > 0)
      misses[block].push_back(offset);
    else
      hits[block][offset] = {static_cast<std::uint16_t>(offset), static_cast<std::uint16_t>(number(0, classes)),
                             weight_step * static_cast<std::uint32_t>(number(1, 3))};
  }
  std::map<BlockIndex, BlockVotes> blocks;
  FrameVotes votes;
  for (const auto& [block, offsets] : misses)
    for (const int offset : offsets)
      if (!hits[block].contains(offset))
        blocks[block].misses[static_cast<std::size_t>(offset) / 64] |= std::uint64_t{1} << (offset % 64);
  for (const auto& [block, of_block] : hits) {
    blocks[block].hits_begin = static_cast<std::uint32_t>(votes.hits.size());
    for (const auto& [offset, hit] : of_block) votes.hits.push_back(hit);
    blocks[block].hits_end = static_cast<std::uint32_t>(votes.hits.size());
  }
  for (auto& [block, of_block] : blocks) {
    of_block.block = block;
    votes.blocks.push_back(of_block);
  }
  return votes;
}

inline VoxelMap random_map(unsigned seed, double resolution_m = 0.1, int frames = 20,
                           std::uint32_t weight_step = kOneVote) {
  std::mt19937 random(seed);
  VoxelMap map(resolution_m);
  for (int i = 0; i < frames; ++i) map.add(random_votes(random, weight_step));
  return map;
}

}  // namespace lapis::mapping::test
