#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "planner/core/space/planning_grid.hpp"

namespace lapis::planner {

struct FrontierConfig {
  double max_extent_m = 2.0;  ///< diagonal of a frontier's box; longer ones are split
  int representatives = 3;    ///< cells that stand for all of them
};

/// A piece of the border between free and unknown space.
struct Frontier {
  std::uint32_t id = 0;                ///< never used again for another one
  std::vector<Cell> cells;             ///< sorted, 8-connected
  std::vector<Cell> representatives;   ///< the cell nearest to the centroid, then each the farthest from those
  Eigen::Vector2d centroid_map{0, 0};  ///< of the cells' centres [m]; may lie beside the frontier
  double length_m = 0.0;               ///< number of cells times resolution
  double extent_m = 0.0;               ///< diagonal of the box around the cells
};

/// All frontiers of a grid, kept up to date by changed cells only. A frontier cell is a free cell with an unknown one
/// among its four straight neighbours. Frontiers are the 8-connected components of frontier cells; one whose box has a
/// longer diagonal than max_extent_m is cut across the middle of the longer side, and so on. All are listed, single
/// cells and unreachable ones included: whoever leaves one out says why (viewpoints.hpp).
///
/// The cells of the frontiers depend on the grid alone, not on the updates that led to it. An id lives on in the new
/// frontier that shares most cells with the old one (ties: smaller old id, then first cell); others get new ids.
class FrontierMap {
 public:
  explicit FrontierMap(const FrontierConfig& config) : config_(config) {}

  /// `changed` names every cell whose state changed since the last call, the first time every known cell.
  void update(const PlanningGrid& grid, std::span<const Cell> changed);
  /// By id.
  const std::map<std::uint32_t, Frontier>& frontiers() const { return frontiers_; }

 private:
  struct Member {
    Cell cell;
    std::uint32_t old_id;  ///< of the frontier that the cell belonged to
  };
  using Group = std::vector<Member>;
  struct Mark {
    std::uint32_t id = 0;       ///< of the frontier that the cell belongs to; 0: none
    std::uint32_t renewed = 0;  ///< the last update that looked at the cell
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
