#include "planner/core/space/alternative_paths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "planner/core/space/line.hpp"

namespace lapis::planner {
namespace {

constexpr int kSearchesPerPath = 3;
constexpr float kSurcharge = 0.5F;  // per metre, added near a path each time that it is found

/// Cells on the straight lines of a path; each is a neighbour of the one before.
std::vector<Cell> cells_on(const Path& path) {
  std::vector<Cell> cells{path.cells.front()};
  for (std::size_t i = 1; i < path.cells.size(); ++i) {
    walk_line(path.cells[i - 1], path.cells[i], [&](Cell c, double share) {
      if (share > 0.0 && c != cells.back()) cells.push_back(c);
      return true;
    });
  }
  return cells;
}

/// True when a cell that is not free lies inside the loop formed by two paths with common ends. Each row is filled
/// between pairs of crossings (even-odd rule); a step between two rows is a crossing of the lower row, at the cell of
/// the step in that row.
bool encloses_obstacle(const PlanningGrid& grid, const std::vector<Cell>& a, const std::vector<Cell>& b) {
  std::vector<Cell> crossings;
  for (const std::vector<Cell>* cells : {&a, &b})
    for (std::size_t i = 1; i < cells->size(); ++i)
      if ((*cells)[i].y != (*cells)[i - 1].y) crossings.push_back(std::min((*cells)[i], (*cells)[i - 1]));
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2)
    for (Cell c = crossings[i] + Cell{1, 0}; c < crossings[i + 1]; ++c.x)
      if (grid.state(c) != mapping::kFree) return true;
  return false;
}

/// Largest distance from a cell of `cells` to the nearest cell of `other` [cells].
double largest_gap(const std::vector<Cell>& cells, const std::vector<Cell>& other) {
  std::int64_t largest = 0;
  for (const Cell& c : cells) {
    std::int64_t gap = std::numeric_limits<std::int64_t>::max();
    for (const Cell& o : other) gap = std::min(gap, squared_distance(c, o));
    largest = std::max(largest, gap);
  }
  return std::sqrt(static_cast<double>(largest));
}

/// Raises the cost of all cells within `radius` [cells] of a path, once per cell.
void raise_cost(const std::vector<Cell>& cells, double radius, SparseGrid<float>& surcharge) {
  const int reach = static_cast<int>(radius);
  std::vector<Cell> around;
  Cell last = cells.front();
  for (const Cell& middle : cells) {
    if (middle != cells.front() && middle != cells.back() && distance(middle, last) < 0.5 * radius) continue;
    last = middle;
    for (Cell step{0, -reach}; step.y <= reach; ++step.y)
      for (step.x = -reach; step.x <= reach; ++step.x)
        if (distance(step, {}) <= radius) around.push_back(middle + step);
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  for (const Cell& c : around) surcharge[c] += kSurcharge;
}

}  // namespace

std::vector<Path> find_alternatives(const PlanningGrid& grid, const PathConfig& config, Cell from, Cell to, int count) {
  std::vector<Path> found;
  std::vector<std::vector<Cell>> found_cells;  // cells of `found`
  if (!grid.is_traversable(to)) return found;
  const double apart = config.min_apart_m / grid.resolution_m();
  SparseGrid<float> surcharge;
  for (int i = 0; i < kSearchesPerPath * count && found.size() < static_cast<std::size_t>(count); ++i) {
    PathQuery query{from, to};
    query.surcharge = &surcharge;
    Path path = straightened(grid, config, grow_cost_tree(grid, config, query).path_to(to));
    if (path.cells.empty()) break;
    std::vector<Cell> cells = cells_on(path);
    raise_cost(cells, apart, surcharge);
    const bool is_distinct = std::all_of(found_cells.begin(), found_cells.end(), [&](const std::vector<Cell>& other) {
      return largest_gap(cells, other) >= apart && encloses_obstacle(grid, cells, other);
    });
    if (!is_distinct || (!found.empty() && path.length_m > config.max_detour * found.front().length_m)) continue;
    found_cells.push_back(std::move(cells));
    found.push_back(std::move(path));
  }
  return found;
}

}  // namespace lapis::planner
