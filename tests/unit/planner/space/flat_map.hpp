#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "common/mapping/model/voxel_map.hpp"
#include "planner/core/space/planning_grid.hpp"

namespace lapis::planner::test {

/// Voxel map of the lowest layer in the robot's height band, cell by cell.
class FlatMap {
 public:
  explicit FlatMap(double resolution_m)
      : map_(resolution_m),
        layer_(static_cast<std::int32_t>(std::ceil(mapping::HeightBand{}.min_height_m / resolution_m - 0.5))) {}

  const mapping::VoxelMap& map() const { return map_; }
  std::int8_t at(Cell c) const {
    const auto block = cells_.find(block_of(c));
    return block == cells_.end() ? mapping::kUnknown : block->second[offset(c)];
  }
  void set(Cell c, std::int8_t value) {
    if (at(c) == value) return;
    auto [block, is_new] = cells_.try_emplace(block_of(c));
    if (is_new) block->second.fill(mapping::kUnknown);
    block->second[offset(c)] = value;
    dirty_.insert(block_of(c));
  }
  /// Writes the cells that were set to the map; returns the blocks that changed.
  std::vector<mapping::BlockIndex> flush() {
    for (const mapping::BlockIndex& index : dirty_) map_.set_block(index, block_from(cells_.at(index)));
    std::vector<mapping::BlockIndex> changed(dirty_.begin(), dirty_.end());
    dirty_.clear();
    return changed;
  }

 private:
  using Cells = std::array<std::int8_t, 64>;

  mapping::BlockIndex block_of(Cell c) const { return mapping::block_of({c.x, c.y, layer_}); }
  static std::size_t offset(Cell c) { return static_cast<std::size_t>((c.y & 7) << 3 | (c.x & 7)); }
  mapping::VoxelBlock block_from(const Cells& cells) const {
    std::array<std::uint32_t, mapping::kBlockVoxels> misses{};
    std::vector<mapping::HitVote> hits;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::size_t voxel = static_cast<std::size_t>(layer_ & 7) * 64 + i;
      if (cells[i] == mapping::kFree) misses[voxel] = 3 * mapping::kOneVote;
      if (cells[i] == mapping::kOccupied) hits.push_back({static_cast<std::uint16_t>(voxel), 1, 3 * mapping::kOneVote});
    }
    return mapping::VoxelBlock(misses, hits);
  }

  mapping::VoxelMap map_;
  std::int32_t layer_;
  std::map<mapping::BlockIndex, Cells> cells_;
  std::set<mapping::BlockIndex> dirty_;
};

/// A map and the grid that follows it.
struct World {
  explicit World(double resolution_m = 0.25, const GridConfig& config = {})
      : map(resolution_m), grid(config, resolution_m) {}

  /// The grid takes over what was set; returns the cells that changed.
  std::vector<Cell> update() { return grid.update_map(map.map(), reader, map.flush()); }

  FlatMap map;
  PlanningGrid grid;
  mapping::BeliefReader reader{mapping::SensorModel{}};
};

/// A world seen from above, the last line at y = 0: '#' occupied, ' ' unknown, everything else free. Letters are
/// places.
struct TextWorld : World {
  explicit TextWorld(const std::vector<std::string>& lines, double resolution_m = 0.25, const GridConfig& config = {})
      : World(resolution_m, config) {
    for (std::size_t row = 0; row < lines.size(); ++row) {
      for (std::size_t column = 0; column < lines[row].size(); ++column) {
        const Cell c{static_cast<std::int32_t>(column), static_cast<std::int32_t>(lines.size() - 1 - row)};
        const char what = lines[row][column];
        if (what != ' ') map.set(c, what == '#' ? mapping::kOccupied : mapping::kFree);
        if (what >= 'A' && what <= 'Z') places[what] = c;
      }
    }
    known = update();
  }

  std::map<char, Cell> places;
  std::vector<Cell> known;  ///< at the beginning
};

}  // namespace lapis::planner::test
