#include "simulator/core/robot/slab_raster.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapis::simulator {
namespace {

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void extend(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// Keeps the part of a convex polygon on which sign * z <= limit.
SlabPolygon keep_below(const SlabPolygon& in, double sign, double limit) {
  SlabPolygon out;
  for (std::size_t i = 0; i < in.size; ++i) {
    const Eigen::Vector3d& a = in.corners[i];
    const Eigen::Vector3d& b = in.corners[i + 1 == in.size ? 0 : i + 1];
    const double over_a = sign * a.z() - limit, over_b = sign * b.z() - limit;
    if (over_a <= 0) out.corners[out.size++] = a;
    if ((over_a < 0 && over_b > 0) || (over_a > 0 && over_b < 0))
      out.corners[out.size++] = a + (b - a) * (over_a / (over_a - over_b));
  }
  return out;
}

/// Extent in x of the part of an edge that lies in low <= y <= high.
void extend_by_edge(Range& x, const Eigen::Vector2d& a, const Eigen::Vector2d& b, double low, double high) {
  const double from = std::clamp(a.y(), low, high), to = std::clamp(b.y(), low, high);
  if (std::min(a.y(), b.y()) > high || std::max(a.y(), b.y()) < low) return;
  const double rise = b.y() - a.y();
  const auto x_at = [&](double y) { return a.x() + (b.x() - a.x()) * ((y - a.y()) / rise); };
  x.extend(from == a.y() ? a.x() : x_at(from));
  x.extend(to == b.y() ? b.x() : x_at(to));
}

int clamped_floor(double value, int size) {
  return static_cast<int>(std::clamp(std::floor(value), -1.0, static_cast<double>(size)));
}

}  // namespace

SlabPolygon clip(const std::array<Eigen::Vector3d, 3>& triangle, const Slab& slab) {
  SlabPolygon polygon;
  std::copy(triangle.begin(), triangle.end(), polygon.corners.begin());
  polygon.size = 3;
  return keep_below(keep_below(polygon, 1.0, slab.high), -1.0, -slab.low);
}

void mark(const SlabPolygon& polygon, const Grid& grid, geometry::GrayImage& cells) {
  if (polygon.size == 0) return;
  std::array<Eigen::Vector2d, 5> corners;  // in cells
  Range all_y;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    corners[i] = (polygon.corners[i].head<2>() - grid.origin) / grid.resolution_m;
    all_y.extend(corners[i].y());
  }
  const int first = std::max(clamped_floor(all_y.low, grid.height), 0);
  const int last = std::min(clamped_floor(all_y.high, grid.height), grid.height - 1);
  for (int row = first; row <= last; ++row) {
    Range x;
    for (std::size_t i = 0; i < polygon.size; ++i) {
      const std::size_t next = i + 1 == polygon.size ? 0 : i + 1;
      extend_by_edge(x, corners[i], corners[next], row, row + 1.0);
    }
    const int from = std::max(clamped_floor(x.low, grid.width), 0);
    const int to = std::min(clamped_floor(x.high, grid.width), grid.width - 1);
    for (int column = from; column <= to; ++column) cells(column, row) = 255;
  }
}

}  // namespace lapis::simulator
