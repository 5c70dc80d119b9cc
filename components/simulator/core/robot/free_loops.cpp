#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "simulator/core/robot/grid_steps.hpp"
#include "simulator/core/robot/reachability.hpp"
#include "simulator/core/robot/regions.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kResolution_m = 0.05;
constexpr double kNoLoop = std::numeric_limits<double>::infinity();

struct Island {
  std::vector<Cell> cells;
  Eigen::Vector2d middle{0, 0};
};

/// A line from an island to the outside, between the rows `from.row` and `from.row + 1`. A closed path winds around
/// the island when it crosses the line an odd number of times.
struct Cut {
  Cell from;          ///< a cell of the island
  int direction = 1;  ///< 1 or -1, along the columns

  bool is_beyond(double column) const { return (column - from.column) * direction > 0; }
  bool is_crossed(Cell a, Cell b) const {
    const bool changes_row = std::min(a.row, b.row) == from.row && a.row != b.row;
    return changes_row && is_beyond(0.5 * (a.column + b.column));
  }
};

/// Cells of a coarser grid that can be reached from the most open one at or next to the start.
geometry::GrayImage reachable_cells(const NavMap& map, const Grid& grid, const Eigen::Vector2d& start,
                                    double radius_m) {
  const Cell c = grid.cell_of(start);
  Cell seed = c;
  for (const Cell step : kGridSteps) {
    const Cell next{c.column + step.column, c.row + step.row};
    if (grid.contains(next) && map.distance_m(grid.center(next)) > map.distance_m(grid.center(seed))) seed = next;
  }
  return region_around(free_cells(map, grid, radius_m), seed);
}

/// Regions of cells that cannot be reached, without those that touch the border.
std::vector<Island> find_islands(const geometry::GrayImage& reachable, const Grid& grid, double least_area_m2) {
  geometry::GrayImage others(grid.width, grid.height);
  std::transform(reachable.pixels.begin(), reachable.pixels.end(), others.pixels.begin(),
                 [](std::uint8_t pixel) { return pixel == 0 ? std::uint8_t{255} : std::uint8_t{0}; });
  const Regions regions = find_regions(others, Neighbours::kEight);
  std::vector<Island> islands(regions.sizes.size());
  std::vector<bool> is_outside(regions.sizes.size(), false);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      const std::uint32_t label = regions.labels(column, row);
      if (label == 0) continue;
      islands[label - 1].cells.push_back({column, row});
      islands[label - 1].middle += grid.center({column, row}) / static_cast<double>(regions.sizes[label - 1]);
      const bool is_border = row == 0 || column == 0 || row + 1 == grid.height || column + 1 == grid.width;
      if (is_border) is_outside[label - 1] = true;
    }
  }
  const double least_cells = least_area_m2 / (grid.resolution_m * grid.resolution_m);
  std::vector<Island> out;
  for (std::size_t i = 0; i < islands.size(); ++i) {
    if (!is_outside[i] && static_cast<double>(islands[i].cells.size()) > least_cells) out.push_back(islands[i]);
  }
  return out;
}

/// The cut that crosses the fewest free cells, of all that begin at a cell of the island and run along its row.
Cut cheapest_cut(const Island& island, const geometry::GrayImage& reachable) {
  Cut best;
  int fewest = std::numeric_limits<int>::max();
  int row = -1;
  std::vector<int> before(static_cast<std::size_t>(reachable.width) + 1);  // number of free cells left of each column
  for (const Cell c : island.cells) {
    if (c.row != row) {
      row = c.row;
      for (int i = 0; i < reachable.width; ++i) {
        const auto at = static_cast<std::size_t>(i);
        before[at + 1] = before[at] + (is_set(reachable, {i, row}) ? 1 : 0);
      }
    }
    const int left = before[static_cast<std::size_t>(c.column)], right = before.back() - left;
    if (std::min(left, right) >= fewest) continue;
    fewest = std::min(left, right);
    best = {c, right <= left ? 1 : -1};
  }
  return best;
}

/// Searches for loops on two layers: a step across the cut changes the layer, so a path from a cell to itself on the
/// other layer winds around the island.
class LoopSearch {
 public:
  LoopSearch(const geometry::GrayImage& reachable, const Cut& cut)
      : reachable_(reachable), cut_(cut), layer_(reachable.pixels.size()), cost_(2 * layer_, kNoLoop),
        parent_(2 * layer_) {}

  /// Cells of the shortest loop; empty when there is none.
  std::vector<Cell> shortest() {
    std::vector<Cell> best;
    double best_length = kNoLoop;
    for (Cell c = cut_.from; c.column >= 0 && c.column < reachable_.width; c.column += cut_.direction) {
      if (!is_set(reachable_, c)) continue;
      const double length = search(c, best_length);
      if (length < best_length) {
        best_length = length;
        best = trace(c);
      }
      for (const std::size_t node : touched_) cost_[node] = kNoLoop;
      touched_.clear();
    }
    return best;
  }

 private:
  std::size_t index_of(Cell c) const {
    return static_cast<std::size_t>(c.row) * static_cast<std::size_t>(reachable_.width) +
           static_cast<std::size_t>(c.column);
  }
  Cell cell_at(std::size_t node) const {
    const auto width = static_cast<std::size_t>(reachable_.width);
    const std::size_t index = node % layer_;
    return {static_cast<int>(index % width), static_cast<int>(index / width)};
  }

  void reach(std::size_t node, double cost, std::size_t parent) {
    if (cost_[node] == kNoLoop) touched_.push_back(node);
    cost_[node] = cost;
    parent_[node] = parent;
  }

  /// Length of the shortest loop through `seed` [cells]; infinite when that is not below `bound`. A*: the rest of a
  /// loop is at least as long as the straight line back.
  double search(Cell seed, double bound) {
    using Entry = std::pair<double, std::size_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    const std::size_t start = index_of(seed), goal = start + layer_;
    reach(start, 0.0, start);
    open.emplace(0.0, start);
    while (!open.empty()) {
      const Entry entry = open.top();
      open.pop();
      const std::size_t node = entry.second;
      if (node == goal) return cost_[goal];
      const Cell c = cell_at(node);
      if (entry.first > cost_[node] + straight(c, seed)) continue;
      for (const Cell step : kGridSteps) {
        if (!can_step(reachable_, c, step)) continue;
        const Cell next{c.column + step.column, c.row + step.row};
        const bool is_upper = (node >= layer_) != cut_.is_crossed(c, next);
        const std::size_t to = index_of(next) + (is_upper ? layer_ : 0);
        const double cost = cost_[node] + step_length(step), estimate = cost + straight(next, seed);
        if (cost >= cost_[to] || estimate >= bound) continue;
        reach(to, cost, node);
        open.emplace(estimate, to);
      }
    }
    return kNoLoop;
  }

  static double straight(Cell a, Cell b) { return step_length({a.column - b.column, a.row - b.row}); }

  std::vector<Cell> trace(Cell seed) const {
    const std::size_t start = index_of(seed);
    std::vector<Cell> cells;
    for (std::size_t node = start + layer_; node != start; node = parent_[node]) cells.push_back(cell_at(node));
    cells.push_back(seed);
    return cells;
  }

  const geometry::GrayImage& reachable_;
  Cut cut_;
  std::size_t layer_;
  std::vector<double> cost_;
  std::vector<std::size_t> parent_, touched_;
};

std::vector<std::string> rooms_on(const Path& path, const std::vector<Room>& rooms) {
  std::vector<std::string> ids;
  for (const auto& p : path) {
    const auto room =
        std::find_if(rooms.begin(), rooms.end(), [&](const Room& candidate) { return contains(candidate.polygon, p); });
    if (room == rooms.end() || std::find(ids.begin(), ids.end(), room->id) != ids.end()) continue;
    ids.push_back(room->id);
  }
  return ids;
}

}  // namespace

std::vector<FreeLoop> find_loops(const NavMap& map, const std::vector<Room>& rooms, const Eigen::Vector2d& start,
                                 double radius_m, double least_area_m2) {
  const Grid grid = coarsened(map.grid(), kResolution_m);
  const geometry::GrayImage reachable = reachable_cells(map, grid, start, radius_m);
  std::vector<FreeLoop> loops;
  for (const Island& island : find_islands(reachable, grid, least_area_m2)) {
    FreeLoop loop;
    loop.island = island.middle;
    loop.island_area_m2 = static_cast<double>(island.cells.size()) * kResolution_m * kResolution_m;
    for (const Cell c : LoopSearch(reachable, cheapest_cut(island, reachable)).shortest())
      loop.path.push_back(grid.center(c));
    loop.length_m = length_m(loop.path);
    loop.rooms = rooms_on(loop.path, rooms);
    loops.push_back(std::move(loop));
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const FreeLoop& a, const FreeLoop& b) { return a.length_m > b.length_m; });
  return loops;
}

}  // namespace lapis::simulator
