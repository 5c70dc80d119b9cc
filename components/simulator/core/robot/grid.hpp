#pragma once

#include <cmath>

#include <Eigen/Core>

namespace lapis::simulator {

struct Cell {
  int column = 0, row = 0;
  bool operator==(const Cell&) const = default;
};

/// Square cells over the floor plan; column 0 and row 0 are the ones with the lowest x and y.
struct Grid {
  Eigen::Vector2d origin{0, 0};  ///< lower left corner of cell (0, 0) [m]
  double resolution_m = 0.025;
  int width = 0, height = 0;

  bool contains(Cell c) const { return c.column >= 0 && c.row >= 0 && c.column < width && c.row < height; }
  Eigen::Vector2d center(Cell c) const { return origin + resolution_m * Eigen::Vector2d(c.column + 0.5, c.row + 0.5); }
  /// Cell of a finite point; the nearest cell for points outside.
  Cell cell_of(const Eigen::Vector2d& p) const {
    const Eigen::Vector2d q = (p - origin) / resolution_m;
    return {nearest(q.x(), width), nearest(q.y(), height)};
  }

 private:
  static int nearest(double coordinate, int size) {
    return static_cast<int>(std::floor(std::fmin(std::fmax(coordinate, 0.0), size - 1.0)));
  }
};

}  // namespace lapis::simulator
