#pragma once

#include <array>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "tests/support/synthetic_room.hpp"

namespace lapis::test {

/// A furnished flat of six rooms with doors between them, and a walk through all of them. Axes as furnished_room().
inline constexpr double kRoomLength_m = 8.0;  ///< along x
inline constexpr double kRoomWidth_m = 6.4;   ///< along y
inline constexpr double kRoomHeight_m = 2.6;

/// Wall along x or y with a door of 0.9 x 2 m whose near edge is `door_m` after the wall's beginning.
inline void add_wall_with_door(std::vector<Box>& boxes, const Eigen::Vector3d& begin, bool is_along_x, double length_m,
                               double door_m) {
  constexpr double kHalfThickness_m = 0.06, kDoorWidth_m = 0.9, kDoorHeight_m = 2.0;
  const Eigen::Vector3d along = is_along_x ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d half = (is_along_x ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX()) * kHalfThickness_m;
  const auto add = [&](double from_m, double to_m, double low_m, double high_m, std::uint16_t label) {
    boxes.push_back({begin + along * from_m - half + Eigen::Vector3d::UnitZ() * low_m,
                     begin + along * to_m + half + Eigen::Vector3d::UnitZ() * high_m, label});
  };
  add(0.0, door_m, 0.0, kRoomHeight_m, 1);
  add(door_m + kDoorWidth_m, length_m, 0.0, kRoomHeight_m, 1);
  add(door_m, door_m + kDoorWidth_m, kDoorHeight_m, kRoomHeight_m, 4);
}

inline std::vector<Box> furnished_flat() {
  using Furniture = std::vector<Box>;
  // In a room of 5 m x 4 m, from its corner; the larger rooms here keep sizes and stretch places. The middle and the
  // doors stay free.
  constexpr double kStretch = kRoomLength_m / 5.0;
  const std::array<Furniture, 6> rooms = {{
      {{{0.2, 3.0, 0}, {2.2, 3.9, 0.8}, 8}, {{0.8, 0.3, 0}, {1.8, 1.0, 0.45}, 6}, {{4.4, 0.1, 0}, {4.9, 1.2, 1.9}, 11}},
      {{{0.1, 0.1, 0}, {1.6, 0.7, 0.9}, 15},
       {{3.4, 2.9, 0.7}, {4.7, 3.7, 0.75}, 6},
       {{3.5, 3.0, 0}, {3.6, 3.1, 0.7}, 6}},
      {{{3.0, 0.1, 0}, {4.9, 1.5, 0.55}, 9},
       {{0.2, 3.4, 0}, {1.8, 3.9, 2.1}, 10},
       {{4.5, 3.4, 0}, {4.8, 3.7, 1.2}, 17}},
      {{{0.1, 0.2, 0}, {0.6, 2.0, 2.0}, 10},
       {{3.2, 3.2, 0}, {4.8, 3.9, 0.75}, 14},
       {{3.7, 2.6, 0}, {4.2, 3.0, 0.9}, 7}},
      {{{0.3, 2.9, 0}, {1.9, 3.8, 0.6}, 13},
       {{4.3, 0.2, 0}, {4.9, 0.8, 0.45}, 16},
       {{0.2, 0.1, 0}, {1.0, 0.5, 1.1}, 11}},
      {{{0.1, 3.3, 0}, {1.7, 3.9, 0.9}, 15}, {{3.0, 0.3, 0}, {4.6, 1.1, 0.8}, 8}, {{4.6, 3.0, 0}, {4.9, 3.6, 1.8}, 18}},
  }};
  const Eigen::Vector3d size(3 * kRoomLength_m, 2 * kRoomWidth_m, kRoomHeight_m);
  std::vector<Box> boxes = {
      {{0, 0, -0.3}, {size.x(), size.y(), 0}, 2}, {{0, 0, size.z()}, {size.x(), size.y(), size.z() + 0.3}, 3},
      {{-0.3, 0, 0}, {0, size.y(), size.z()}, 1}, {{size.x(), 0, 0}, {size.x() + 0.3, size.y(), size.z()}, 1},
      {{0, -0.3, 0}, {size.x(), 0, size.z()}, 1}, {{0, size.y(), 0}, {size.x(), size.y() + 0.3, size.z()}, 1},
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 2; ++j) {
      const Eigen::Vector3d corner(i * kRoomLength_m, j * kRoomWidth_m, 0);
      const int room = 3 * j + i;
      for (const Box& box : rooms[static_cast<std::size_t>(room)]) {
        const Eigen::Vector3d low = corner + box.low.cwiseProduct(Eigen::Vector3d(kStretch, kStretch, 1.0));
        boxes.push_back({low, low + box.high - box.low, box.label});
      }
      boxes.push_back({corner + Eigen::Vector3d(3.0, 2.2, 0), corner + Eigen::Vector3d(4.8, 3.6, 0.015), 23});
      boxes.push_back({corner + Eigen::Vector3d(3.6, 0.07, 1.2), corner + Eigen::Vector3d(4.5, 0.1, 1.8), 12});
      if (i > 0) add_wall_with_door(boxes, corner, false, kRoomWidth_m, 2.7);
      if (j > 0) add_wall_with_door(boxes, corner, true, kRoomLength_m, 5.4);
    }
  return boxes;
}

/// Camera poses of a walk through the rooms, `per_room` in each: they look once around across every room, and the last
/// of a room looks towards the next.
inline std::vector<geometry::Pose> walk_through_flat(int per_room) {
  const std::array<std::pair<int, int>, 6> order = {{{0, 0}, {1, 0}, {2, 0}, {2, 1}, {1, 1}, {0, 1}}};
  std::vector<geometry::Pose> poses;
  double leave_rad = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const auto& [i, j] = order[k];
    const auto& [next_i, next_j] = order[std::min(k + 1, order.size() - 1)];
    if (k + 1 < order.size()) leave_rad = std::atan2(next_j - j, next_i - i);
    const Eigen::Vector3d center((i + 0.5) * kRoomLength_m, (j + 0.5) * kRoomWidth_m, 1.0);
    for (int n = 1; n <= per_room; ++n) {
      const double turn_rad = leave_rad + 2.0 * M_PI * n / per_room;
      const Eigen::Vector3d p = center - Eigen::Vector3d(1.5 * std::cos(turn_rad), 1.2 * std::sin(turn_rad), 0.02 * n);
      poses.push_back(look(p, turn_rad, 0.1 * (n % 3)));
    }
  }
  return poses;
}

/// Depth noise of standard deviation 0.0013 z^2 m per pixel, and one patch of 8x8 pixels in fifty with a wrong label.
inline void add_noise(RenderedFrame& frame, std::mt19937& random) {
  constexpr int kPatch = 8;
  std::normal_distribution<float> normal;
  for (float& z : frame.depth.pixels) z += 0.0013f * z * z * normal(random);
  std::uniform_int_distribution<int> one_in_fifty(0, 49), label(1, 23);
  for (int row = 0; row < frame.labels.height; row += kPatch)
    for (int column = 0; column < frame.labels.width; column += kPatch) {
      if (one_in_fifty(random) != 0) continue;
      const auto wrong = static_cast<std::uint16_t>(label(random));
      for (int y = row; y < std::min(row + kPatch, frame.labels.height); ++y)
        for (int x = column; x < std::min(column + kPatch, frame.labels.width); ++x) frame.labels(x, y) = wrong;
    }
}

}  // namespace lapis::test
