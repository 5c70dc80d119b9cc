#include "simulator/core/robot/regions.hpp"

#include <span>

#include "simulator/core/robot/grid_steps.hpp"

namespace lapis::simulator {
namespace {

/// Grows a region from `seed` over all cells that `take` accepts; it must accept each cell only once. Returns its size.
template <class Take>
std::size_t flood(Cell seed, int width, int height, Neighbours neighbours, Take take) {
  const std::span<const Cell> steps = std::span(kGridSteps).first(neighbours == Neighbours::kFour ? 4 : 8);
  std::vector<Cell> open;
  std::size_t size = 0;
  if (take(seed)) open.push_back(seed);
  while (!open.empty()) {
    const Cell c = open.back();
    open.pop_back();
    ++size;
    for (const Cell step : steps) {
      const Cell next{c.column + step.column, c.row + step.row};
      const bool is_inside = next.column >= 0 && next.row >= 0 && next.column < width && next.row < height;
      if (is_inside && take(next)) open.push_back(next);
    }
  }
  return size;
}

}  // namespace

Regions find_regions(const geometry::GrayImage& cells, Neighbours neighbours) {
  Regions out;
  out.labels = geometry::Image<std::uint32_t>(cells.width, cells.height);
  for (int row = 0; row < cells.height; ++row) {
    for (int column = 0; column < cells.width; ++column) {
      const auto label = static_cast<std::uint32_t>(out.sizes.size() + 1);
      const auto take = [&](Cell c) {
        if (cells(c.column, c.row) == 0 || out.labels(c.column, c.row) != 0) return false;
        out.labels(c.column, c.row) = label;
        return true;
      };
      const std::size_t size = flood({column, row}, cells.width, cells.height, neighbours, take);
      if (size > 0) out.sizes.push_back(size);
    }
  }
  return out;
}

geometry::GrayImage region_around(const geometry::GrayImage& cells, Cell seed) {
  geometry::GrayImage region(cells.width, cells.height);
  flood(seed, cells.width, cells.height, Neighbours::kFour, [&](Cell c) {
    if (cells(c.column, c.row) == 0 || region(c.column, c.row) != 0) return false;
    region(c.column, c.row) = 255;
    return true;
  });
  return region;
}

}  // namespace lapis::simulator
