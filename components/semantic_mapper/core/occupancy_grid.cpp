#include "semantic_mapper/core/occupancy_grid.hpp"

#include <algorithm>
#include <cstddef>

namespace lapis::semantic_mapper {

OccupancyGrid make_grid(std::span<const GridCell> cells, double resolution_m) {
  OccupancyGrid grid;
  grid.resolution_m = resolution_m;
  if (cells.empty()) return grid;
  const auto by_x = [](const GridCell& a, const GridCell& b) { return a.x < b.x; };
  const auto by_y = [](const GridCell& a, const GridCell& b) { return a.y < b.y; };
  const auto [west, east] = std::minmax_element(cells.begin(), cells.end(), by_x);
  const auto [south, north] = std::minmax_element(cells.begin(), cells.end(), by_y);
  const std::int32_t low_x = west->x, low_y = south->y;
  grid.origin_x_m = low_x * resolution_m;
  grid.origin_y_m = low_y * resolution_m;
  grid.width = east->x - low_x + 1;
  grid.height = north->y - low_y + 1;
  grid.cells.assign(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height), kUnknown);
  for (const GridCell& cell : cells) {
    const auto row = static_cast<std::size_t>(cell.y - low_y), column = static_cast<std::size_t>(cell.x - low_x);
    std::int8_t& value = grid.cells[row * static_cast<std::size_t>(grid.width) + column];
    value = std::max(value, cell.value);
  }
  return grid;
}

}  // namespace lapis::semantic_mapper
