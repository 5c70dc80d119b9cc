#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "planner/core/space/planning_grid.hpp"

namespace lapis::planner {

struct PathConfig {
  double comfort_m = 0.5;        ///< clearance from which on nearness costs nothing; <= max_clearance_m
  double nearness_weight = 2.0;  ///< a metre at the least clearance costs 1 + this
  double escape_m = 1.5;         ///< the robot may leave a place that is not traversable within this
  double max_detour = 1.5;       ///< an alternative's length over that of the best path
  double min_apart_m = 1.0;      ///< an alternative is so far from every other path somewhere
};

/// Cost of a metre in a cell: 1 + nearness_weight * n^2, n from 1 at the least clearance to 0 at comfort_m.
double cost_per_metre(const PlanningGrid& grid, const PathConfig& config, Cell c);

struct PathQuery {
  Cell from;
  std::optional<Cell> to = std::nullopt;  ///< the search ends here; without, all cells within the bound are reached
  double max_cost_m = std::numeric_limits<double>::infinity();
  const SparseGrid<float>* surcharge = nullptr;  ///< added to the cost of a metre in each cell, >= 0
};

/// Cheapest paths from one cell to others. A path steps to one of eight neighbours, diagonally only where both cells
/// beside are open too; a step costs its length times the mean cost per metre of its ends.
class CostTree {
 public:
  /// Cost of the cheapest path from the root [m at cost 1]; nothing for cells that were not reached.
  std::optional<double> cost_m(Cell c) const;
  /// The cells from the root to `to`, both included; empty when `to` was not reached.
  std::vector<Cell> path_to(Cell to) const;
  /// All cells that were reached, the cheapest first.
  const std::vector<Cell>& reached() const { return reached_; }

 private:
  friend class PathSearch;
  static constexpr std::uint8_t kRoot = 8, kNoStep = 9;
  struct Node {
    double cost = std::numeric_limits<double>::infinity();
    std::uint8_t step = kNoStep;  ///< that led here, index of kSteps
    bool is_final = false;
    bool operator==(const Node&) const = default;
  };

  SparseGrid<Node> nodes_;
  std::vector<Cell> reached_;
};

/// Dijkstra's algorithm from the root, or A* with the octile distance when the query names a goal. Equal costs are
/// visited in the order of cells, so that paths are reproducible.
///
/// Open are passable cells. A robot that stands where it should not (beside a wall, in unknown space, in a cell that
/// turned occupied) may still leave: until the path has come to its first traversable cell, it may enter any cell
/// within escape_m of the start that is not occupied and has room for the robot, or at least as much clearance as the
/// cell it comes from; so it never gets nearer to a wall that it touches, and never through one.
CostTree grow_cost_tree(const PlanningGrid& grid, const PathConfig& config, const PathQuery& query);

}  // namespace lapis::planner
