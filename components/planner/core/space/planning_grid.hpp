#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/model/column_projection.hpp"
#include "common/time/time.hpp"
#include "planner/core/space/distance_field.hpp"

namespace lapis::planner {

struct GridConfig {
  mapping::HeightBand band;          ///< what the robot can run into
  double bottom_m = 0.25;            ///< lowest part of the band, which must have been seen in free cells
  double footprint_radius_m = 0.20;  ///< of the robot's disc
  double margin_m = 0.05;            ///< kept besides
  double max_clearance_m = 1.0;      ///< distances are known up to here
  double obstacle_expiry_s = 10.0;   ///< an obstacle that no grid shows any more is forgotten
};

/// Occupancy by cell, row by row from the lower left corner; axes parallel to those of the map frame.
struct ObstacleGrid {
  Eigen::Vector2d origin{0, 0};  ///< lower left corner of cell 0 in the map frame [m]
  double resolution_m = 0.0;
  int width = 0;
  int height = 0;
  std::vector<std::int8_t> cells;  ///< row by row; >= 50: occupied, 0 to 49: free, -1: unknown

  std::int8_t at(int column, int row) const {
    return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
};

/// Grids that reach farther from the origin of the map frame are not believed [m].
inline constexpr double kMaxReach_m = 1000.0;

/// Cells about which a planning grid knows what its map does not.
struct GridMarks {
  std::vector<Cell> driven;    ///< the robot has stood there
  std::vector<Cell> hindered;  ///< occupied whatever the map says: by obstacles, or because the robot cannot pass

  bool operator==(const GridMarks&) const = default;
};

/// Floor plan in which the robot plans: the projection of the map's voxels (column_projection.hpp) under a layer of
/// obstacles that come and go. Free are only cells whose bottom has been seen: a camera looks over what is low and
/// near. An obstacle makes its cell occupied until a grid says that it is free or until no grid has shown it for
/// `obstacle_expiry_s`; what the map says is occupied stays so.
///
/// Clearance is measured from centre to centre: walls are taken to be in the middle of their cells. A cell is
/// traversable when it is free, its clearance is at least footprint radius + margin, and unknown cells, whose edges
/// count, are at least the footprint radius away: what stands there, nobody knows. Passable are these and, unless
/// something is seen there, cells on which the robot has stood, with unknown ones beside them or themselves unknown:
/// under and just around itself its camera does not see the floor, and without them there may be no path back.
class PlanningGrid {
 public:
  /// @param resolution_m edge of a cell: that of the map.
  PlanningGrid(const GridConfig& config, double resolution_m);

  /// Takes over what `changed` blocks of the map say: all whose content is not what it was at the last call, those that
  /// are gone included. The first time, and with another sensor model, all blocks of the map are looked at.
  /// All updates return the cells whose state() is another one than before, each once, in a fixed order.
  std::vector<Cell> update_map(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                               std::span<const mapping::BlockIndex> changed);
  /// Lays a grid over the plan. Nothing, and no change, when it is malformed: not as many cells as width x height, a
  /// resolution outside [0.01, 1] m, or cells beyond kMaxReach_m.
  std::optional<std::vector<Cell>> update_obstacles(const ObstacleGrid& grid, time::Time stamp);
  /// Cells that the robot found it cannot pass, whatever is seen there: occupied until they are left out here.
  std::vector<Cell> set_blocked(std::set<Cell> cells);
  /// The robot is there [m, map]. A later correction of the map does not move such places.
  void mark_driven(const Eigen::Vector2d& robot_map);
  /// Sorted. In a grid of the same map set_marks() makes every state and every passable cell the same again; obstacles
  /// do not expire there.
  GridMarks marks() const;
  std::vector<Cell> set_marks(const GridMarks& marks);
  /// Forgets obstacles that were last seen more than `obstacle_expiry_s` before `now`.
  std::vector<Cell> expire_obstacles(time::Time now);

  /// mapping::kOccupied, kFree or kUnknown.
  std::int8_t state(Cell c) const { return state_.at(c); }
  /// The same by the map alone.
  std::int8_t mapped_state(Cell c) const { return mapped_.at(c); }
  /// All cells of a state() other than kUnknown; sorted.
  std::vector<Cell> cells_in(std::int8_t state) const { return state_.cells_with(state); }
  /// Distance to the nearest occupied cell, at most max_clearance_m() [m].
  double clearance_m(Cell c) const;
  /// True when an obstacle stands where the map says that it is free: it may go away.
  bool has_passing_obstacles() const;
  /// Far enough from what is occupied.
  bool has_room(Cell c) const { return to_occupied_.squared(c) >= required_squared_; }
  bool is_traversable(Cell c) const {
    return state(c) == mapping::kFree && has_room(c) && to_unknown_.squared(c) >= unknown_squared_;
  }
  /// Paths may lead there; goals are traversable.
  bool is_passable(Cell c) const { return is_traversable(c) || (driven_.at(c) && is_unhindered(c)); }

  const GridConfig& config() const { return config_; }
  double resolution_m() const { return resolution_m_; }
  /// The clearance that traversable cells have [m].
  double required_clearance_m() const { return config_.footprint_radius_m + config_.margin_m; }
  Cell cell_of(const Eigen::Vector2d& p_map) const;
  Eigen::Vector2d center_of(Cell c) const { return resolution_m_ * Eigen::Vector2d(c.x + 0.5, c.y + 0.5); }
  /// Memory of the cells [bytes].
  std::size_t bytes() const;

 private:
  mapping::ColumnCells floor_plan(const mapping::BlockColumn& column, const mapping::VoxelMap& map,
                                  const mapping::BeliefReader& reader) const;
  bool is_unhindered(Cell c) const {
    return state(c) == mapping::kUnknown || (state(c) == mapping::kFree && has_room(c));
  }
  void erase_freed(const ObstacleGrid& grid, std::vector<Cell>& touched);
  void mark_seen(const ObstacleGrid& grid, time::Time stamp, std::vector<Cell>& touched);
  std::vector<Cell> renew(std::span<const Cell> touched);

  GridConfig config_;
  double resolution_m_;
  int required_squared_;  ///< least squared distance to occupied cells of traversable ones [cells^2]
  int unknown_squared_;   ///< least squared distance to unknown cells of traversable ones [cells^2]
  std::optional<mapping::SensorModel> model_;  ///< of the last update_map
  SparseGrid<std::int8_t> mapped_;             ///< the map's part
  std::map<Cell, time::Time> obstacles_;       ///< when last seen
  std::set<Cell> blocked_;
  SparseGrid<std::int8_t> state_;  ///< all together
  SparseGrid<bool> driven_;
  DistanceField to_occupied_;
  DistanceField to_unknown_;
};

}  // namespace lapis::planner
