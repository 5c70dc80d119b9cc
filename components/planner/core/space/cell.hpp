#pragma once

#include <array>
#include <cmath>
#include <compare>
#include <cstdint>
#include <numbers>

#include <Eigen/Core>

namespace lapis::planner {

/// Cell of the floor plan; x and y as in mapping::VoxelIndex. Cells are ordered by y, then by x.
struct Cell {
  std::int32_t x = 0;
  std::int32_t y = 0;

  constexpr bool operator==(const Cell&) const = default;
  constexpr std::strong_ordering operator<=>(const Cell& other) const {
    const auto by_y = y <=> other.y;
    return by_y != 0 ? by_y : x <=> other.x;
  }
};

constexpr Cell operator+(Cell a, Cell b) { return {a.x + b.x, a.y + b.y}; }
constexpr Cell operator-(Cell a, Cell b) { return {a.x - b.x, a.y - b.y}; }

/// Square of the distance between the centres of two cells [cells^2].
constexpr std::int64_t squared_distance(Cell a, Cell b) {
  const std::int64_t x = a.x - b.x, y = a.y - b.y;
  return x * x + y * y;
}

/// Distance between the centres of two cells [cells].
inline double distance(Cell a, Cell b) { return std::sqrt(static_cast<double>(squared_distance(a, b))); }

/// Steps to the eight neighbours: first the four straight ones, then the four diagonal ones. The diagonal step 4 + i
/// lies between the straight steps i and (i + 1) % 4.
inline constexpr std::array<Cell, 8> kSteps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
inline constexpr std::size_t kStraightSteps = 4;

/// Position and heading in the map frame.
struct Pose2 {
  Eigen::Vector2d p_map{0, 0};  ///< [m]
  double yaw_rad = 0.0;         ///< counter-clockwise from the x axis

  bool operator==(const Pose2&) const = default;
};

/// Angle between two headings, in [0, pi] [rad].
inline double turn_between(double yaw_rad, double other_rad) {
  return std::abs(std::remainder(yaw_rad - other_rad, 2.0 * std::numbers::pi));
}

}  // namespace lapis::planner
