#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/mapping/model/voxel_map.hpp"

namespace lapis::test {

/// Voxel map of a building drawn from above, the last line at y = 0: '#' wall, '.' floor, ' ' unknown. Each cell is a
/// column of eight voxels from the ground up.
inline mapping::VoxelMap drawn_map(const std::vector<std::string>& lines, double resolution_m) {
  struct Votes {
    std::array<std::uint32_t, mapping::kBlockVoxels> misses{};
    std::map<std::uint16_t, mapping::HitVote> hits;
  };
  std::map<mapping::BlockIndex, Votes> blocks;
  const auto height = static_cast<std::int32_t>(lines.size());
  for (std::int32_t y = 0; y < height; ++y) {
    const std::string& line = lines[static_cast<std::size_t>(height - 1 - y)];
    for (std::int32_t x = 0; x < static_cast<std::int32_t>(line.size()); ++x) {
      const char what = line[static_cast<std::size_t>(x)];
      if (what == ' ') continue;
      Votes& votes = blocks[mapping::block_of({x, y, 0})];
      for (std::uint16_t z = 0; z < mapping::kBlockEdge; ++z) {
        const auto voxel = static_cast<std::uint16_t>(64 * z + 8 * (y & 7) + (x & 7));
        if (what == '#') votes.hits[voxel] = {voxel, 1, 3 * mapping::kOneVote};
        if (what == '.') votes.misses[voxel] = 3 * mapping::kOneVote;
      }
    }
  }
  mapping::VoxelMap map(resolution_m);
  for (const auto& [index, votes] : blocks) {
    std::vector<mapping::HitVote> hits;
    for (const auto& entry : votes.hits) hits.push_back(entry.second);
    map.set_block(index, mapping::VoxelBlock(votes.misses, hits));
  }
  return map;
}

}  // namespace lapis::test
