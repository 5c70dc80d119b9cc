#include "semantic_mapper/core/obstacle_layer.hpp"

#include <bit>
#include <stdexcept>
#include <vector>

namespace lapis::semantic_mapper {

using mapping::BlockIndex;

ObstacleLayer::ObstacleLayer(const ObstacleConfig& config, const mapping::HeightBand& band, double resolution_m)
    : config_(config), band_(band), resolution_m_(resolution_m) {
  if (!(config.window_s >= 0.1 && config.window_s <= 600.0))
    throw std::runtime_error("obstacles: window_s must be in [0.1, 600]");
  if (config.misses_to_clear < 1 || config.misses_to_clear > 100)
    throw std::runtime_error("obstacles: misses_to_clear must be in [1, 100]");
}

bool ObstacleLayer::touches_band(const BlockIndex& index) const {
  const std::int32_t first = mapping::voxel_at(index, 0).z;
  for (std::int32_t z = first; z < first + mapping::kBlockEdge; ++z)
    if (mapping::is_in_band(z, resolution_m_, band_)) return true;
  return false;
}

std::int64_t ObstacleLayer::oldest_stamp() const {
  return (newest_ - time::Duration::from_seconds(config_.window_s)).nanoseconds;
}

void ObstacleLayer::add(time::Time stamp, const mapping::FrameVotes& votes) {
  newest_ = stamp;
  for (const mapping::BlockVotes& of_block : votes.blocks) {
    if (!touches_band(of_block.block)) continue;
    Block& block = blocks_[of_block.block];
    block.newest = stamp.nanoseconds;
    add_misses(of_block, block);
    for (std::uint32_t i = of_block.hits_begin; i < of_block.hits_end; ++i) {
      block.seen[votes.hits[i].offset] = stamp.nanoseconds;
      block.misses_since_hit[votes.hits[i].offset] = 0;
    }
  }
  forget();
}

void ObstacleLayer::add_misses(const mapping::BlockVotes& votes, Block& block) const {
  const auto cleared = static_cast<std::uint8_t>(config_.misses_to_clear);
  const std::int64_t oldest = oldest_stamp();
  for (std::size_t word = 0; word < votes.misses.size(); ++word) {
    for (std::uint64_t bits = votes.misses[word]; bits != 0; bits &= bits - 1) {
      const std::size_t offset = word * 64 + static_cast<std::size_t>(std::countr_zero(bits));
      std::uint8_t& misses = block.misses_since_hit[offset];
      if (block.seen[offset] < oldest) misses = cleared;  // what was there before is forgotten
      if (misses < cleared) ++misses;
      block.seen[offset] = newest_.nanoseconds;
    }
  }
}

void ObstacleLayer::forget() {
  const std::int64_t oldest = oldest_stamp();
  std::erase_if(blocks_, [oldest](const auto& entry) { return entry.second.newest < oldest; });
}

OccupancyGrid ObstacleLayer::grid() const {
  const std::int64_t oldest = oldest_stamp();
  std::vector<GridCell> cells;  // in any order: the grid takes the largest value at each place
  for (const auto& [index, block] : blocks_) {
    for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) {
      const auto i = static_cast<std::size_t>(offset);
      if (block.seen[i] < oldest) continue;
      const mapping::VoxelIndex voxel = mapping::voxel_at(index, offset);
      if (!mapping::is_in_band(voxel.z, resolution_m_, band_)) continue;
      cells.push_back({voxel.x, voxel.y, block.misses_since_hit[i] < config_.misses_to_clear ? kOccupied : kFree});
    }
  }
  return make_grid(cells, resolution_m_);
}

}  // namespace lapis::semantic_mapper
