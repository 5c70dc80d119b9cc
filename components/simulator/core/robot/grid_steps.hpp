#pragma once

#include <array>
#include <cmath>

#include "common/geometry/image.hpp"
#include "simulator/core/robot/grid.hpp"

namespace lapis::simulator {

/// Steps to neighbouring cells: the four straight ones, then the four diagonal ones.
inline constexpr std::array<Cell, 8> kGridSteps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};

inline bool is_set(const geometry::GrayImage& cells, Cell c) {
  return c.column >= 0 && c.row >= 0 && c.column < cells.width && c.row < cells.height && cells(c.column, c.row) != 0;
}

/// True when a step leads to a free cell. Diagonal steps do not cut corners, so that steps join only 4-connected cells.
inline bool can_step(const geometry::GrayImage& free_cells, Cell from, Cell step) {
  const Cell to{from.column + step.column, from.row + step.row};
  return is_set(free_cells, to) && is_set(free_cells, {to.column, from.row}) &&
         is_set(free_cells, {from.column, to.row});
}

/// Length of a step [cells].
inline double step_length(Cell step) { return std::hypot(step.column, step.row); }

}  // namespace lapis::simulator
