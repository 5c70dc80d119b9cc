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

/// The convex part of a triangle that is inside a slab (low < high). It has at most five corners, because the first cut
/// adds two adjacent corners on its plane, whose edge the second cut does not touch; none when they do not meet.
struct SlabPolygon {
  std::array<Eigen::Vector3d, 5> corners;
  std::size_t size = 0;
};

/// Clips a triangle exactly to low <= z <= high [Sutherland, Hodgman, CACM 1974].
SlabPolygon clip(const std::array<Eigen::Vector3d, 3>& triangle, const Slab& slab);

/// Sets every cell to 255 that has a point in common with the polygon as seen from above (cells are half-open: a line
/// on the border of two belongs to the upper or right one). Parts outside the grid are left out.
void mark(const SlabPolygon& polygon, const Grid& grid, geometry::GrayImage& cells);

}  // namespace lapis::simulator
