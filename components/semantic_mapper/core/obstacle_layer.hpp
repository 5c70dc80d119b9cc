#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/model/voxel_index.hpp"
#include "common/time/time.hpp"
#include "semantic_mapper/core/occupancy_grid.hpp"

namespace lapis::semantic_mapper {

struct ObstacleConfig {
  double window_s = 10.0;   ///< what was seen longer ago is forgotten
  int misses_to_clear = 3;  ///< frames that must look through an obstacle before it is gone
};

/// What stands in the way now, beside a map that takes the world to be static: the newest evidence wins. A voxel of the
/// band is occupied from a hit on until `misses_to_clear` frames have looked through it without another hit, or until
/// it has not been seen for `window_s`. Poses are those at which the frames were integrated; a correction of the pose
/// graph affects only the frames that follow.
class ObstacleLayer {
 public:
  /// Throws std::runtime_error that names the value that is out of range.
  ObstacleLayer(const ObstacleConfig& config, const mapping::HeightBand& band, double resolution_m);

  /// Adds the votes of a frame (integration.hpp); stamps must not go back.
  void add(time::Time stamp, const mapping::FrameVotes& votes);
  /// A column with any occupied voxel is occupied; any other with a voxel that was seen within the window is free.
  OccupancyGrid grid() const;
  /// Memory [bytes], bounded by the part of the band that can be seen within the window.
  std::size_t bytes() const { return blocks_.size() * (sizeof(Block) + sizeof(mapping::BlockIndex)); }

 private:
  struct Block {
    Block() { seen.fill(std::numeric_limits<std::int64_t>::min()); }
    std::int64_t newest = 0;                                             ///< stamp of the last vote [ns]
    std::array<std::int64_t, mapping::kBlockVoxels> seen;                ///< stamp of the voxel's last vote [ns]
    std::array<std::uint8_t, mapping::kBlockVoxels> misses_since_hit{};  ///< misses_to_clear = free
  };

  bool touches_band(const mapping::BlockIndex& index) const;
  void add_misses(const mapping::BlockVotes& votes, Block& block) const;
  void forget();
  std::int64_t oldest_stamp() const;  ///< of the window [ns]

  ObstacleConfig config_;
  mapping::HeightBand band_;
  double resolution_m_;
  time::Time newest_;
  std::unordered_map<mapping::BlockIndex, Block, mapping::GridIndexHash> blocks_;
};

}  // namespace lapis::semantic_mapper
