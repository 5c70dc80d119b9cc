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
  mapping::HeightBand band;          ///< heights in which the robot may collide
  double bottom_m = 0.25;            ///< lowest part of the band, which has to be seen for a cell to be free
  double footprint_radius_m = 0.20;  ///< of the robot's disc
  double margin_m = 0.05;            ///< clearance in addition to the footprint radius
  double max_clearance_m = 1.0;      ///< larger distances are not computed
  double obstacle_expiry_s = 10.0;   ///< time after which an obstacle that no grid shows any more is forgotten
};

/// Occupancy by cell, row by row from the lower left corner; the axes are parallel to those of the map frame.
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

/// Grids that reach farther than this from the origin of the map frame are refused [m].
inline constexpr double kMaxReach_m = 1000.0;

/// What a planning grid knows about cells in addition to its map.
struct GridMarks {
  std::vector<Cell> driven;    ///< cells on which the robot has stood
  std::vector<Cell> hindered;  ///< occupied whatever the map says: by obstacles, or because the robot cannot pass there

  bool operator==(const GridMarks&) const = default;
};

/// Floor plan on which the robot plans: the projection of the map's voxels (column_projection.hpp) below a layer of
/// obstacles that come and go. Only cells whose bottom has been seen are free, because the camera looks over low
/// objects near the robot. An obstacle makes its cell occupied until a grid shows the cell free, or until no grid has
/// shown the obstacle for `obstacle_expiry_s`. Cells that the map says are occupied stay occupied.
///
/// Clearance is measured from centre to centre, as if walls were in the middle of their cells. A cell is traversable
/// when it is free, its clearance is at least footprint radius + margin, and the edges of unknown cells are at least
/// the footprint radius away, because unknown cells may be occupied. A cell is passable when it is traversable, or when
/// the robot has stood on it and it is unknown, or free with that clearance but with unknown cells nearby: the camera
/// does not see the floor below and just around the robot, and without these cells there may be no path back.
class PlanningGrid {
 public:
  /// @param resolution_m edge of a cell; must be that of the map
  PlanningGrid(const GridConfig& config, double resolution_m);

  /// Updates the floor plan from the map. At the first call, and with another sensor model, all blocks of the map are
  /// read. All updates return the cells whose state() has changed, each once, in a fixed order.
  /// @param changed all blocks whose content has changed since the last call, including removed ones
  std::vector<Cell> update_map(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                               std::span<const mapping::BlockIndex> changed);
  /// Applies an obstacle grid: its occupied cells become obstacles, and its free cells remove obstacles. Returns
  /// nothing, and changes nothing, when the grid is malformed: its number of cells is not width x height, its
  /// resolution is outside [0.01, 1] m, or cells are beyond kMaxReach_m.
  std::optional<std::vector<Cell>> update_obstacles(const ObstacleGrid& grid, time::Time stamp);
  /// Sets all cells that the robot cannot pass, whatever is seen there; they are occupied until a call leaves them out.
  std::vector<Cell> set_blocked(std::set<Cell> cells);
  /// The robot is at this position [m, map]. Later corrections of the map do not move these marks.
  void mark_driven(const Eigen::Vector2d& robot_map);
  /// The marks, sorted. set_marks() on a grid of the same map reproduces every state and every passable cell; obstacles
  /// do not expire there.
  GridMarks marks() const;
  std::vector<Cell> set_marks(const GridMarks& marks);
  /// Forgets obstacles that were last seen more than `obstacle_expiry_s` before `now`.
  std::vector<Cell> expire_obstacles(time::Time now);

  /// mapping::kOccupied, kFree or kUnknown.
  std::int8_t state(Cell c) const { return state_.at(c); }
  /// The same, by the map alone.
  std::int8_t mapped_state(Cell c) const { return mapped_.at(c); }
  /// All cells with this state(), which must not be kUnknown; sorted.
  std::vector<Cell> cells_in(std::int8_t state) const { return state_.cells_with(state); }
  /// Distance to the nearest occupied cell, at most GridConfig::max_clearance_m [m].
  double clearance_m(Cell c) const;
  /// True when an obstacle, which may go away, stands where the map is free.
  bool has_passing_obstacles() const;
  /// True when the cell is far enough from occupied cells.
  bool has_room(Cell c) const { return to_occupied_.squared(c) >= required_squared_; }
  bool is_traversable(Cell c) const {
    return state(c) == mapping::kFree && has_room(c) && to_unknown_.squared(c) >= unknown_squared_;
  }
  /// True when paths may lead through the cell. Goals have to be traversable.
  bool is_passable(Cell c) const { return is_traversable(c) || (driven_.at(c) && is_unhindered(c)); }

  const GridConfig& config() const { return config_; }
  double resolution_m() const { return resolution_m_; }
  /// Least clearance of traversable cells [m].
  double required_clearance_m() const { return config_.footprint_radius_m + config_.margin_m; }
  Cell cell_of(const Eigen::Vector2d& p_map) const;
  Eigen::Vector2d center_of(Cell c) const { return resolution_m_ * Eigen::Vector2d(c.x + 0.5, c.y + 0.5); }
  /// Memory of all cells [bytes].
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
  int required_squared_;  ///< least squared distance from a traversable cell to occupied ones [cells^2]
  int unknown_squared_;   ///< least squared distance from a traversable cell to unknown ones [cells^2]
  std::optional<mapping::SensorModel> model_;  ///< of the last call of update_map
  SparseGrid<std::int8_t> mapped_;             ///< state by the map alone
  std::map<Cell, time::Time> obstacles_;       ///< time at which each was seen last
  std::set<Cell> blocked_;
  SparseGrid<std::int8_t> state_;  ///< state by map, obstacles and blocked cells
  SparseGrid<bool> driven_;
  DistanceField to_occupied_;
  DistanceField to_unknown_;
};

}  // namespace lapis::planner
