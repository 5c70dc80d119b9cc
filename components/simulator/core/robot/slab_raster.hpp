#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "simulator/core/robot/grid.hpp"

namespace lapis::simulator {

/// Heights between which triangles count [m].
struct Slab {
  double low = 0.0, high = 0.0;
};

/// The convex polygon that a slab leaves of a triangle: at most five corners (the first cut leaves two new ones beside
/// each other on its plane, which the second one does not touch), none when they do not meet. low < high.
struct SlabPolygon {
  std::array<Eigen::Vector3d, 5> corners;
  std::size_t size = 0;
};

/// Clips a triangle exactly to low <= z <= high [Sutherland, Hodgman, CACM 1974].
SlabPolygon clip(const std::array<Eigen::Vector3d, 3>& triangle, const Slab& slab);

/// Sets every cell that the polygon, seen from above, has a point in common with (cells are half-open: a line on the
/// border of two belongs to the upper or right one) to 255. Parts outside the grid are left out.
void mark(const SlabPolygon& polygon, const Grid& grid, geometry::GrayImage& cells);

}  // namespace lapis::simulator
