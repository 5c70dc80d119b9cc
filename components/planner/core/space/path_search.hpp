#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "planner/core/space/planning_grid.hpp"

namespace lapis::planner {

struct PathConfig {
  double comfort_m = 0.5;        ///< clearance above which nearness costs nothing; <= max_clearance_m
  double nearness_weight = 2.0;  ///< a metre at the least clearance costs 1 + this
  double escape_m = 1.5;         ///< radius within which the robot may leave a place that is not traversable
  double max_detour = 1.5;       ///< largest ratio of an alternative's length to that of the best path
  double min_apart_m = 1.0;      ///< an alternative is somewhere at least this far from every other path
};

/// Cost of a metre in a cell: 1 + nearness_weight * n^2, where n falls from 1 at the least clearance to 0 at comfort_m.
double cost_per_metre(const PlanningGrid& grid, const PathConfig& config, Cell c);

struct PathQuery {
  Cell from;
  std::optional<Cell> to = std::nullopt;  ///< the search ends here; if empty, it reaches all cells within max_cost_m
  double max_cost_m = std::numeric_limits<double>::infinity();
  const SparseGrid<float>* surcharge = nullptr;  ///< added to the cost of a metre in each cell, >= 0
};

/// Cheapest paths from one cell to others. A path steps to one of the eight neighbours; a diagonal step requires that
/// both cells beside it are open, too. A step costs its length times the mean of the costs per metre of its two cells.
class CostTree {
 public:
  /// Cost of the cheapest path from the root, in metres at a cost per metre of 1; empty for cells that were not
  /// reached.
  std::optional<double> cost_m(Cell c) const;
  /// Cells from the root to `to`, both included; empty when `to` was not reached.
  std::vector<Cell> path_to(Cell to) const;
  /// All cells that were reached, in the order of their cost.
  const std::vector<Cell>& reached() const { return reached_; }

 private:
  friend class PathSearch;
  static constexpr std::uint8_t kRoot = 8, kNoStep = 9;
  struct Node {
    double cost = std::numeric_limits<double>::infinity();
    std::uint8_t step = kNoStep;  ///< the step that led here, as index of kSteps
    bool is_final = false;
    bool operator==(const Node&) const = default;
  };

  SparseGrid<Node> nodes_;
  std::vector<Cell> reached_;
};

/// Dijkstra's algorithm from the root, or A* with the octile distance when the query names a goal. Cells of equal cost
/// are visited in the order of cells, so that paths are reproducible.
///
/// Passable cells are open. A robot that stands where it should not (beside a wall, in unknown space, in a cell that
/// became occupied) may leave: until its path reaches the first traversable cell, it may enter any cell within escape_m
/// of the start that is not occupied and has room for the robot, or has at least as much clearance as the cell before.
/// So the robot never gets nearer to a wall that it touches, and never drives through one.
CostTree grow_cost_tree(const PlanningGrid& grid, const PathConfig& config, const PathQuery& query);

}  // namespace lapis::planner
