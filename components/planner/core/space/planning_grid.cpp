#include "planner/core/space/planning_grid.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

namespace lapis::planner {
namespace {

using mapping::kBlockEdge;

constexpr std::int8_t kOccupiedFrom = 50;
constexpr double kRounding_cells = 1e-6;  // tolerance for borders of cells that should coincide

/// Smallest squared distance [cells^2] that is at least a distance [m].
int least_squared(double distance_m, double resolution_m) {
  const double cells = distance_m / resolution_m;
  return static_cast<int>(std::ceil(cells * cells - kRounding_cells));
}

int reach_cells(const GridConfig& config, double resolution_m) {
  const double reach_m = std::max(
      {config.max_clearance_m, config.footprint_radius_m + config.margin_m, config.footprint_radius_m + resolution_m});
  return static_cast<int>(std::ceil(reach_m / resolution_m - kRounding_cells));
}

bool is_well_formed(const ObstacleGrid& grid) {
  if (grid.width < 0 || grid.height < 0 || !(grid.resolution_m >= 0.01 && grid.resolution_m <= 1.0)) return false;
  const Eigen::Vector2d end = grid.origin + grid.resolution_m * Eigen::Vector2d(grid.width, grid.height);
  return grid.origin.minCoeff() >= -kMaxReach_m && end.maxCoeff() <= kMaxReach_m && grid.origin.allFinite() &&
         grid.cells.size() == static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height);
}

}  // namespace

PlanningGrid::PlanningGrid(const GridConfig& config, double resolution_m)
    : config_(config), resolution_m_(resolution_m),
      required_squared_(least_squared(config.footprint_radius_m + config.margin_m, resolution_m)),
      unknown_squared_(least_squared(config.footprint_radius_m + 0.5 * resolution_m, resolution_m)),
      mapped_(mapping::kUnknown), state_(mapping::kUnknown),
      to_occupied_(mapping::kOccupied, reach_cells(config, resolution_m)),
      to_unknown_(mapping::kUnknown, reach_cells(config, resolution_m)) {}

/// The projection of a column; free cells become unknown where the bottom of the height band has not been seen.
mapping::ColumnCells PlanningGrid::floor_plan(const mapping::BlockColumn& column, const mapping::VoxelMap& map,
                                              const mapping::BeliefReader& reader) const {
  const double bottom_m =
      std::min(config_.band.min_height_m + std::max(config_.bottom_m, resolution_m_), config_.band.max_height_m);
  mapping::ColumnCells cells = mapping::project_column(column, map, reader, config_.band);
  const mapping::ColumnCells bottom =
      mapping::project_column(column, map, reader, {config_.band.min_height_m, bottom_m});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (cells[i] == mapping::kFree) cells[i] = bottom[i];
  }
  return cells;
}

std::vector<Cell> PlanningGrid::update_map(const mapping::VoxelMap& map, const mapping::BeliefReader& reader,
                                           std::span<const mapping::BlockIndex> changed) {
  std::set<mapping::BlockColumn> columns;
  for (const mapping::BlockIndex& block : changed) columns.insert({block.x, block.y});
  if (model_ != reader.model())
    for (const mapping::BlockIndex& block : map.sorted_blocks()) columns.insert({block.x, block.y});
  model_ = reader.model();
  std::vector<Cell> touched;
  for (const mapping::BlockColumn& column : columns) {
    const mapping::ColumnCells cells = floor_plan(column, map, reader);
    for (std::int32_t i = 0; i < kBlockEdge * kBlockEdge; ++i) {
      const Cell c{column.x * kBlockEdge + i % kBlockEdge, column.y * kBlockEdge + i / kBlockEdge};
      if (mapped_.at(c) == cells[static_cast<std::size_t>(i)]) continue;
      mapped_[c] = cells[static_cast<std::size_t>(i)];
      touched.push_back(c);
    }
  }
  return renew(touched);
}

std::optional<std::vector<Cell>> PlanningGrid::update_obstacles(const ObstacleGrid& grid, time::Time stamp) {
  if (!is_well_formed(grid)) return std::nullopt;
  std::vector<Cell> touched;
  erase_freed(grid, touched);
  mark_seen(grid, stamp, touched);
  std::vector<Cell> changed = renew(touched);
  const std::vector<Cell> expired = expire_obstacles(stamp);
  changed.insert(changed.end(), expired.begin(), expired.end());
  return changed;
}

void PlanningGrid::erase_freed(const ObstacleGrid& grid, std::vector<Cell>& touched) {
  for (auto entry = obstacles_.begin(); entry != obstacles_.end();) {
    const Eigen::Vector2d place = (center_of(entry->first) - grid.origin) / grid.resolution_m;
    const auto column = static_cast<int>(std::floor(place.x())), row = static_cast<int>(std::floor(place.y()));
    const bool is_inside = column >= 0 && row >= 0 && column < grid.width && row < grid.height;
    const std::int8_t value = is_inside ? grid.at(column, row) : mapping::kUnknown;
    const bool is_freed = value >= 0 && value < kOccupiedFrom;
    if (is_freed) touched.push_back(entry->first);
    entry = is_freed ? obstacles_.erase(entry) : std::next(entry);
  }
}

/// Marks every cell of the plan that an occupied cell of the grid overlaps.
void PlanningGrid::mark_seen(const ObstacleGrid& grid, time::Time stamp, std::vector<Cell>& touched) {
  const auto first = [&](double edge_m) {
    return static_cast<std::int32_t>(std::floor(edge_m / resolution_m_ + kRounding_cells));
  };
  const auto last = [&](double edge_m) {
    return static_cast<std::int32_t>(std::ceil(edge_m / resolution_m_ - kRounding_cells)) - 1;
  };
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (grid.at(column, row) < kOccupiedFrom) continue;
      const Eigen::Vector2d low = grid.origin + grid.resolution_m * Eigen::Vector2d(column, row);
      const Eigen::Vector2d high = grid.origin + grid.resolution_m * Eigen::Vector2d(column + 1, row + 1);
      for (Cell c{0, first(low.y())}; c.y <= last(high.y()); ++c.y) {
        for (c.x = first(low.x()); c.x <= last(high.x()); ++c.x) {
          obstacles_[c] = stamp;
          touched.push_back(c);
        }
      }
    }
  }
}

std::vector<Cell> PlanningGrid::expire_obstacles(time::Time now) {
  const time::Time oldest = now - time::Duration::from_seconds(config_.obstacle_expiry_s);
  std::vector<Cell> touched;
  for (auto entry = obstacles_.begin(); entry != obstacles_.end();) {
    const bool is_over = entry->second < oldest;
    if (is_over) touched.push_back(entry->first);
    entry = is_over ? obstacles_.erase(entry) : std::next(entry);
  }
  return renew(touched);
}

std::vector<Cell> PlanningGrid::set_blocked(std::set<Cell> cells) {
  std::vector<Cell> touched;
  std::set_symmetric_difference(cells.begin(), cells.end(), blocked_.begin(), blocked_.end(),
                                std::back_inserter(touched));
  blocked_ = std::move(cells);
  return renew(touched);
}

/// Marks all cells whose centre is within half a cell's diagonal: consecutive ones share an edge, as the steps of paths
/// do.
void PlanningGrid::mark_driven(const Eigen::Vector2d& robot_map) {
  const Cell middle = cell_of(robot_map);
  for (Cell step{0, -1}; step.y <= 1; ++step.y) {
    for (step.x = -1; step.x <= 1; ++step.x) {
      const Cell c = middle + step;
      if ((center_of(c) - robot_map).norm() <= 0.5 * std::numbers::sqrt2 * resolution_m_) driven_.set(c, true);
    }
  }
}

GridMarks PlanningGrid::marks() const {
  std::set<Cell> hindered = blocked_;
  for (const auto& [cell, seen] : obstacles_) hindered.insert(cell);
  return {driven_.cells_with(true), {hindered.begin(), hindered.end()}};
}

std::vector<Cell> PlanningGrid::set_marks(const GridMarks& marks) {
  for (const Cell& cell : marks.driven) driven_.set(cell, true);
  return set_blocked({marks.hindered.begin(), marks.hindered.end()});
}

bool PlanningGrid::has_passing_obstacles() const {
  return std::any_of(obstacles_.begin(), obstacles_.end(),
                     [&](const auto& entry) { return mapped_.at(entry.first) == mapping::kFree; });
}

/// Updates the state of these cells, and the distances; returns the cells whose state changed.
std::vector<Cell> PlanningGrid::renew(std::span<const Cell> touched) {
  std::vector<Cell> changed;
  for (const Cell& c : touched) {
    const bool is_blocked = blocked_.contains(c) || (!obstacles_.empty() && obstacles_.contains(c));
    const std::int8_t value = is_blocked ? mapping::kOccupied : mapped_.at(c);
    if (state_.at(c) == value) continue;
    state_[c] = value;
    changed.push_back(c);
  }
  to_occupied_.update(state_, changed);
  to_unknown_.update(state_, changed);
  return changed;
}

double PlanningGrid::clearance_m(Cell c) const {
  return std::min(std::sqrt(static_cast<double>(to_occupied_.squared(c))) * resolution_m_, config_.max_clearance_m);
}

Cell PlanningGrid::cell_of(const Eigen::Vector2d& p_map) const {
  return {static_cast<std::int32_t>(std::floor(p_map.x() / resolution_m_)),
          static_cast<std::int32_t>(std::floor(p_map.y() / resolution_m_))};
}

std::size_t PlanningGrid::bytes() const {
  return mapped_.bytes() + state_.bytes() + driven_.bytes() + to_occupied_.bytes() + to_unknown_.bytes();
}

}  // namespace lapis::planner
