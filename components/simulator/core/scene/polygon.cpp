#include "simulator/core/scene/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

namespace lapis::simulator {
namespace {

constexpr double kTolerance_m = 1e-3;

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Positive when `c` is on the left of the line from `a` to `b`.
double side(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return cross(b - a, c - a);
}

const Eigen::Vector2d& corner_after(const Polygon& polygon, std::size_t i) { return polygon[(i + 1) % polygon.size()]; }

double distance_to_segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& p) {
  const Eigen::Vector2d direction = b - a;
  const double t = std::clamp((p - a).dot(direction) / direction.squaredNorm(), 0.0, 1.0);
  return (a + t * direction - p).norm();
}

bool properly_cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
                    const Eigen::Vector2d& d) {
  return side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
}

bool touch(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  return properly_cross(a, b, c, d) || distance_to_segment(a, b, c) < kTolerance_m ||
         distance_to_segment(a, b, d) < kTolerance_m || distance_to_segment(c, d, a) < kTolerance_m ||
         distance_to_segment(c, d, b) < kTolerance_m;
}

bool is_ear(const Polygon& polygon, const std::vector<std::size_t>& rest, std::size_t i) {
  const std::size_t n = rest.size();
  const std::size_t before = rest[(i + n - 1) % n], tip = rest[i], after = rest[(i + 1) % n];
  const auto &a = polygon[before], &b = polygon[tip], &c = polygon[after];
  if (side(a, b, c) <= 0.0) return false;
  return std::none_of(rest.begin(), rest.end(), [&](std::size_t k) {
    if (k == before || k == tip || k == after) return false;
    const auto& p = polygon[k];
    return side(a, b, p) >= 0.0 && side(b, c, p) >= 0.0 && side(c, a, p) >= 0.0;
  });
}

/// True when some edge of `a` has all of `b` on its right.
bool separates(const Polygon& a, const Polygon& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector2d direction = (corner_after(a, i) - a[i]).normalized();
    const auto is_outside = [&](const Eigen::Vector2d& p) { return cross(direction, p - a[i]) < kTolerance_m; };
    if (std::all_of(b.begin(), b.end(), is_outside)) return true;
  }
  return false;
}

}  // namespace

double signed_area(const Polygon& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) twice += cross(polygon[i], corner_after(polygon, i));
  return 0.5 * twice;
}

bool is_simple(const Polygon& polygon) {
  const std::size_t n = polygon.size();
  if (n < 3) return false;
  for (std::size_t i = 0; i < n; ++i) {
    const auto &a = polygon[i], &b = corner_after(polygon, i);
    if ((b - a).norm() < kTolerance_m) return false;
    // A neighbour may touch in the common corner only: it must not fold back.
    if (distance_to_segment(a, b, polygon[(i + 2) % n]) < kTolerance_m) return false;
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n != i && touch(a, b, polygon[j], corner_after(polygon, j))) return false;
    }
  }
  return true;
}

bool contains(const Polygon& polygon, const Eigen::Vector2d& point) {
  bool is_inside = false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto &a = polygon[i], &b = corner_after(polygon, i);
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) is_inside = !is_inside;
  }
  return is_inside;
}

double distance_to_border(const Polygon& polygon, const Eigen::Vector2d& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < polygon.size(); ++i)
    nearest = std::min(nearest, distance_to_segment(polygon[i], corner_after(polygon, i), point));
  return nearest;
}

bool contains(const Polygon& outer, const Polygon& inner) {
  for (std::size_t i = 0; i < inner.size(); ++i) {
    if (!contains(outer, inner[i]) && distance_to_border(outer, inner[i]) > kTolerance_m) return false;
    for (std::size_t j = 0; j < outer.size(); ++j) {
      // A corner of the room that pokes into the item, or a wall that runs through it.
      const auto &c = outer[j], &d = corner_after(outer, j);
      if (properly_cross(inner[i], corner_after(inner, i), c, d) &&
          std::min(distance_to_segment(c, d, inner[i]), distance_to_segment(c, d, corner_after(inner, i))) >
              kTolerance_m) {
        return false;
      }
    }
  }
  return true;
}

bool overlap(const Polygon& a, const Polygon& b) { return !separates(a, b) && !separates(b, a); }

std::vector<std::array<std::size_t, 3>> triangulate(const Polygon& polygon) {
  std::vector<std::size_t> rest(polygon.size());
  std::iota(rest.begin(), rest.end(), std::size_t{0});
  std::vector<std::array<std::size_t, 3>> triangles;
  while (rest.size() > 3) {
    std::size_t ear = 0;
    while (ear + 1 < rest.size() && !is_ear(polygon, rest, ear)) ++ear;
    const std::size_t n = rest.size();
    triangles.push_back({rest[(ear + n - 1) % n], rest[ear], rest[(ear + 1) % n]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (rest.size() == 3) triangles.push_back({rest[0], rest[1], rest[2]});
  return triangles;
}

Polygon clip(Polygon subject, const Polygon& window) {
  for (std::size_t i = 0; i < window.size() && !subject.empty(); ++i) {
    const auto &a = window[i], &b = corner_after(window, i);
    Polygon kept;
    for (std::size_t k = 0; k < subject.size(); ++k) {
      const auto &p = subject[k], &q = corner_after(subject, k);
      const double side_p = side(a, b, p), side_q = side(a, b, q);
      if (side_p >= 0.0) kept.push_back(p);
      if ((side_p >= 0.0) != (side_q >= 0.0)) kept.emplace_back(p + side_p / (side_p - side_q) * (q - p));
    }
    subject = std::move(kept);
  }
  return subject;
}

Polygon rectangle(const Eigen::Vector2d& center, const Eigen::Vector2d& size, double yaw_rad) {
  const Eigen::Rotation2Dd turn(yaw_rad);
  Polygon corners;
  for (const auto& [x, y] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}})
    corners.emplace_back(center + turn * Eigen::Vector2d(x * size.x(), y * size.y()));
  return corners;
}

}  // namespace lapis::simulator
