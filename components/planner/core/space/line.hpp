#pragma once

#include <cstdint>
#include <cstdlib>

#include "planner/core/space/cell.hpp"

namespace lapis::planner {

/// Visits, in order, every cell that the straight line between the centres of two cells touches, with the share of the
/// line in the cell. Where the line passes through a corner, both cells beside the corner are visited with share 0. The
/// order is exact, because integers decide which cell is next. Returns false as soon as visit(Cell, double share) does.
template <class Visitor>
bool walk_line(Cell from, Cell to, Visitor&& visit) {
  const Cell step{to.x < from.x ? -1 : 1, to.y < from.y ? -1 : 1};
  const std::int64_t nx = std::abs(to.x - from.x), ny = std::abs(to.y - from.y);
  // The line leaves the i-th column after the share (2 i + 1) / (2 nx), the j-th row after (2 j + 1) / (2 ny).
  std::int64_t i = 0, j = 0;
  double entered = 0.0;
  Cell c = from;
  while (i < nx || j < ny) {
    const std::int64_t side = (2 * i + 1) * ny - (2 * j + 1) * nx;  // negative: the column ends first
    const double left = side < 0 ? static_cast<double>(2 * i + 1) / static_cast<double>(2 * nx)
                                 : static_cast<double>(2 * j + 1) / static_cast<double>(2 * ny);
    if (!visit(c, left - entered)) return false;
    if (side == 0 && !(visit(Cell{c.x + step.x, c.y}, 0.0) && visit(Cell{c.x, c.y + step.y}, 0.0))) return false;
    if (side <= 0) ++i, c.x += step.x;
    if (side >= 0) ++j, c.y += step.y;
    entered = left;
  }
  return visit(c, 1.0 - entered);
}

}  // namespace lapis::planner
