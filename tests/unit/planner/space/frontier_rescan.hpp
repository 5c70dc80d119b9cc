#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/mapping/model/column_projection.hpp"
#include "planner/core/space/cell.hpp"

namespace lapis::planner::test {

/// Frontiers by the rule as it is written down, from a plain array that is looked at as a whole each time: what
/// FrontierMap must equal, and must be faster than. Groups of cells, each sorted, sorted by their first cell.
class FrontierRescan {
 public:
  FrontierRescan(const geometry::Image<std::int8_t>& states, double max_extent_cells)
      : max_extent_(max_extent_cells), open_(states.width, states.height) {
    for (int y = 0; y < states.height; ++y) {
      const std::int8_t* row = &states.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(states.width)];
      for (int x = 0; x < states.width; ++x)
        if (row[x] == mapping::kFree && touches_unknown(states, x, y)) mark({x, y});
    }
    for (const Cell& seed : std::vector<Cell>(std::move(frontier_cells_)))
      if (open_(seed.x, seed.y) != 0) split(flood(seed));
    std::sort(groups.begin(), groups.end());
  }

  std::vector<std::vector<Cell>> groups;

 private:
  static bool touches_unknown(const geometry::Image<std::int8_t>& states, int x, int y) {
    return x == 0 || y == 0 || x + 1 == states.width || y + 1 == states.height ||
           states(x - 1, y) == mapping::kUnknown || states(x + 1, y) == mapping::kUnknown ||
           states(x, y - 1) == mapping::kUnknown || states(x, y + 1) == mapping::kUnknown;
  }
  void mark(Cell c) {
    open_(c.x, c.y) = 1;
    frontier_cells_.push_back(c);
  }
  std::vector<Cell> flood(Cell seed) {
    std::vector<Cell> group{seed};
    open_(seed.x, seed.y) = 0;
    for (std::size_t i = 0; i < group.size(); ++i) {
      for (const Cell& step : kSteps) {
        const Cell c = group[i] + step;
        if (c.x < 0 || c.y < 0 || c.x >= open_.width || c.y >= open_.height || open_(c.x, c.y) == 0) continue;
        open_(c.x, c.y) = 0;
        group.push_back(c);
      }
    }
    return group;
  }
  void split(std::vector<Cell> group) {
    std::sort(group.begin(), group.end());
    const auto [left, right] =
        std::minmax_element(group.begin(), group.end(), [](const Cell& a, const Cell& b) { return a.x < b.x; });
    const int low_x = left->x, low_y = group.front().y;
    const int width = right->x - low_x + 1, height = group.back().y - low_y + 1;
    if (group.size() == 1 || std::sqrt(width * width + height * height) <= max_extent_) {
      groups.push_back(std::move(group));
      return;
    }
    for (const bool want_low : {true, false}) {
      std::vector<Cell> half;
      for (const Cell& c : group) {
        const bool is_low = width >= height ? c.x - low_x < width / 2 : c.y - low_y < height / 2;
        if (is_low == want_low) half.push_back(c);
      }
      for (const Cell& c : half) open_(c.x, c.y) = 1;
      for (const Cell& c : half)
        if (open_(c.x, c.y) != 0) split(flood(c));
    }
  }

  double max_extent_;
  geometry::GrayImage open_;  ///< frontier cells that are in no group yet
  std::vector<Cell> frontier_cells_;
};

}  // namespace lapis::planner::test
