#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planner/core/space/planning_grid.hpp"

namespace lapis::planner {

struct FrontierConfig {
  double max_extent_m = 2.0;  ///< diagonal of a frontier's box; larger frontiers are split
  int representatives = 3;    ///< number of cells that represent a frontier
};

/// A piece of the boundary between free and unknown space.
struct Frontier {
  std::uint32_t id = 0;                ///< never used again for another frontier
  std::vector<Cell> cells;             ///< sorted, 8-connected
  std::vector<Cell> representatives;   ///< the cell nearest to the centroid, then the farthest from those before
  Eigen::Vector2d centroid_map{0, 0};  ///< of the cells' centres [m]; may lie outside the frontier
  double length_m = 0.0;               ///< number of cells times resolution
  double extent_m = 0.0;               ///< diagonal of the box around the cells
};

/// All frontiers of a grid, updated from changed cells only. A frontier cell is a free cell with an unknown cell among
/// its four straight neighbours. Frontiers are the 8-connected components of frontier cells; a component whose box has
/// a diagonal longer than max_extent_m is cut across the middle of the longer side, recursively. All frontiers are
/// listed, single cells and unreachable ones included; code that leaves one out states why (Rejection).
///
/// The cells of the frontiers depend on the grid alone, not on the updates that led to it. The new frontier that shares
/// most cells with an old one inherits its id (ties: the smaller old id, then the first cell); others get new ids.
class FrontierMap {
 public:
  explicit FrontierMap(const FrontierConfig& config) : config_(config) {}

  /// @param changed every cell whose state has changed since the last call; at the first call, every known cell
  void update(const PlanningGrid& grid, std::span<const Cell> changed);
  /// Frontiers by id.
  const std::map<std::uint32_t, Frontier>& frontiers() const { return frontiers_; }

 private:
  struct Member {
    Cell cell;
    std::uint32_t old_id;  ///< of the frontier that the cell belonged to
  };
  using Group = std::vector<Member>;
  struct Mark {
    std::uint32_t id = 0;       ///< of the frontier that the cell belongs to; 0: none
    std::uint32_t renewed = 0;  ///< number of the last update that visited the cell
  };

  std::vector<Cell> renew_cells(const PlanningGrid& grid, std::span<const Cell> changed);
  Group take_component(Cell seed);
  void split(Group component, double max_extent_cells, std::vector<Group>& pieces);
  void replace(std::vector<Group> pieces, double resolution_m);
  void add(std::uint32_t id, const Group& piece, double resolution_m);

  FrontierConfig config_;
  SparseGrid<Mark> marks_;
  std::map<std::uint32_t, Frontier> frontiers_;
  std::uint32_t last_id_ = 0;
  std::uint32_t updates_ = 0;
};

}  // namespace lapis::planner
