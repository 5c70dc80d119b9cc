#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/mapping/model/column_projection.hpp"
#include "common/mapping/model/frame_votes.hpp"
#include "semantic_mapper/core/occupancy_grid.hpp"

namespace lapis::semantic_mapper {

/// Where frames have looked that are not whole in the map yet: the columns of the robot's height band in which any of
/// them has observed a voxel, free or occupied. A process that chooses views need not choose these again.
class ProvisionalArea {
 public:
  ProvisionalArea(const mapping::HeightBand& band, double resolution_m) : band_(band), resolution_m_(resolution_m) {}

  /// Sets what a frame has observed, without regard to its drift; it replaces what was set before.
  void set(std::size_t frame, const mapping::FrameVotes& votes);
  void erase(std::size_t frame) { changes_ += seen_.erase(frame); }
  bool contains(std::size_t frame) const { return seen_.contains(frame); }
  std::size_t size() const { return seen_.size(); }
  std::uint64_t changes() const { return changes_; }
  /// kFree where any of the frames has looked, else kUnknown; without frames, a grid without cells.
  OccupancyGrid grid() const;

 private:
  /// One bit per cell of a block column: cell x + 8 y.
  using Columns = std::map<mapping::BlockColumn, std::uint64_t>;

  mapping::HeightBand band_;
  double resolution_m_;
  std::uint64_t changes_ = 0;
  std::unordered_map<std::size_t, std::vector<std::pair<mapping::BlockColumn, std::uint64_t>>> seen_;  ///< by frame
};

}  // namespace lapis::semantic_mapper
