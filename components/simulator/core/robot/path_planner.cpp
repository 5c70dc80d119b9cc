#include "simulator/core/robot/path_planner.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "simulator/core/robot/grid_steps.hpp"

namespace lapis::simulator {
namespace {

constexpr double kSnap_m = 0.15;
constexpr double kLineSample_m = 0.025;  // between points of a line that are tested
constexpr double kSlack = 1.001;         // a line may cost this factor more than the path that it replaces
constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::size_t index_of(const Grid& grid, Cell c) {
  return static_cast<std::size_t>(c.row) * static_cast<std::size_t>(grid.width) + static_cast<std::size_t>(c.column);
}

Cell cell_at(const Grid& grid, std::size_t index) {
  const auto width = static_cast<std::size_t>(grid.width);
  return {static_cast<int>(index % width), static_cast<int>(index / width)};
}

}  // namespace

double length_m(const Path& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) sum += (path[i] - path[i - 1]).norm();
  return sum;
}

Grid coarsened(const Grid& grid, double resolution_m) {
  const double ratio = grid.resolution_m / resolution_m;
  return {grid.origin, resolution_m, static_cast<int>(std::ceil(grid.width * ratio)),
          static_cast<int>(std::ceil(grid.height * ratio))};
}

geometry::GrayImage free_cells(const NavMap& map, const Grid& grid, double radius_m) {
  geometry::GrayImage cells(grid.width, grid.height);
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (map.distance_m(grid.center({column, row})) >= radius_m) cells(column, row) = 255;
    }
  }
  return cells;
}

PathPlanner::PathPlanner(const NavMap& map, const PathConfig& config)
    : map_(&map), config_(config), grid_(coarsened(map.grid(), config.resolution_m)),
      free_(free_cells(map, grid_, config.radius_m + config.margin_m)), cost_(grid_.width, grid_.height) {
  for (int row = 0; row < grid_.height; ++row) {
    for (int column = 0; column < grid_.width; ++column)
      cost_(column, row) = cost_per_metre(grid_.center({column, row}));
  }
}

bool PathPlanner::is_free(const Eigen::Vector2d& p) const {
  return map_->distance_m(p) >= config_.radius_m + config_.margin_m;
}

double PathPlanner::cost_per_metre(const Eigen::Vector2d& p) const {
  const double gap = (map_->distance_m(p) - config_.radius_m) / config_.comfort_m;
  const double nearness = 1.0 - std::clamp(gap, 0.0, 1.0);
  return 1.0 + config_.nearness_weight * nearness * nearness;
}

double PathPlanner::segment_cost(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const {
  const double length = (b - a).norm();
  const int samples = std::max(1, static_cast<int>(std::ceil(length / kLineSample_m)));
  double sum = 0.0;
  for (int i = 0; i < samples; ++i) {
    const Eigen::Vector2d p = a + (b - a) * ((i + 0.5) / samples);
    if (!is_free(p)) return kInfinity;
    sum += cost_per_metre(p);
  }
  return sum * length / samples;
}

std::optional<Eigen::Vector2d> PathPlanner::nearest_free(const Eigen::Vector2d& p) const {
  const int reach = static_cast<int>(std::ceil(kSnap_m / grid_.resolution_m));
  const Cell middle = grid_.cell_of(p);
  std::optional<Eigen::Vector2d> best;
  double best_m = kSnap_m;
  for (int row = middle.row - reach; row <= middle.row + reach; ++row) {
    for (int column = middle.column - reach; column <= middle.column + reach; ++column) {
      if (!is_set(free_, {column, row})) continue;
      const Eigen::Vector2d center = grid_.center({column, row});
      const double distance = (center - p).norm();
      if (distance > best_m || (best && distance == best_m)) continue;
      best = center;
      best_m = distance;
    }
  }
  return best;
}

std::optional<Path> PathPlanner::plan(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const {
  const auto first = nearest_free(from), last = nearest_free(to);
  if (!first || !last) return std::nullopt;
  Path path = search(grid_.cell_of(*first), grid_.cell_of(*last));
  if (path.empty()) return std::nullopt;
  if (is_free(to)) path.push_back(to);
  if (is_free(from)) path.insert(path.begin(), from);
  path = shorten(path);
  if (!is_free(from)) path.insert(path.begin(), from);
  return path;
}

Path PathPlanner::search(Cell from, Cell to) const {
  using Entry = std::pair<double, std::size_t>;  // cost from the start plus the least cost to the goal; cell
  const std::size_t none = cost_.pixels.size(), start = index_of(grid_, from), goal = index_of(grid_, to);
  std::vector<double> cost(none, kInfinity);
  std::vector<std::size_t> parent(none, none);
  std::vector<bool> is_closed(none, false);
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  cost[start] = 0.0;
  open.emplace(0.0, start);
  while (!open.empty() && !is_closed[goal]) {
    const std::size_t index = open.top().second;
    open.pop();
    if (is_closed[index]) continue;
    is_closed[index] = true;
    const Cell c = cell_at(grid_, index);
    for (const Cell step : kGridSteps) {
      if (!can_step(free_, c, step)) continue;
      const Cell next{c.column + step.column, c.row + step.row};
      const std::size_t n = index_of(grid_, next);
      const double sum = cost[index] + step_length(step) * 0.5 * (cost_.pixels[index] + cost_.pixels[n]);
      if (sum >= cost[n]) continue;
      cost[n] = sum;
      parent[n] = index;
      open.emplace(sum + std::hypot(next.column - to.column, next.row - to.row), n);
    }
  }
  Path path;
  if (!is_closed[goal]) return path;
  for (std::size_t i = goal; i != none; i = parent[i]) path.push_back(grid_.center(cell_at(grid_, i)));
  std::reverse(path.begin(), path.end());
  return path;
}

/// Replaces parts of a path by straight lines, from each point as far as that costs no more; repeated while it helps.
Path PathPlanner::shorten(const Path& path) const {
  Path out{path.front()};
  for (std::size_t i = 0; i + 1 < path.size();) {
    std::size_t best = i + 1;
    double along = segment_cost(path[i], path[best]);
    for (std::size_t j = i + 2; j < path.size(); ++j) {
      along += segment_cost(path[j - 1], path[j]);
      const double straight = segment_cost(path[i], path[j]);
      if (std::isinf(straight) || straight > kSlack * along) break;
      best = j;
    }
    out.push_back(path[best]);
    i = best;
  }
  return out.size() < path.size() ? shorten(out) : out;
}

}  // namespace lapis::simulator
