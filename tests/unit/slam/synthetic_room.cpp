#include "tests/unit/slam/synthetic_room.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace lapis::slam::test {
namespace {

constexpr std::array<double, 3> kHalfSize_m{3.0, 2.0, 3.0};

// Well mixed bits of a tile's coordinates (finaliser of splitmix64).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

std::uint8_t tile_grey(int wall, double a, double b, double size_m) {
  const auto column = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(a / size_m)) + 1000);
  const auto row = static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(b / size_m)) + 1000);
  return static_cast<std::uint8_t>(mix(column * 7919 + row * 104729 + static_cast<std::uint64_t>(wall)) % 100);
}

}  // namespace

geometry::PinholeCamera small_camera() { return {320, 240, 160.0, 160.0, 159.5, 119.5}; }

RgbdFrame render_room(const geometry::PinholeCamera& camera, const geometry::Pose& T_room_camera, time::Time stamp) {
  RgbdFrame frame{stamp, camera, geometry::GrayImage(camera.width, camera.height),
                  geometry::DepthImage(camera.width, camera.height)};
  const Eigen::Vector3d origin = T_room_camera.translation();
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = T_room_camera.linear() * camera.unproject(x, y, 1.0);
      double depth_m = std::numeric_limits<double>::infinity();
      int wall = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double side = ray[axis] > 0.0 ? 1.0 : -1.0;
        const double distance = (side * kHalfSize_m[static_cast<std::size_t>(axis)] - origin[axis]) / ray[axis];
        if (ray[axis] == 0.0 || distance >= depth_m) continue;
        depth_m = distance;
        wall = 2 * axis + (side > 0.0 ? 1 : 0);
      }
      const Eigen::Vector3d p = origin + depth_m * ray;
      const double a = p[(wall / 2 + 1) % 3];
      const double b = p[(wall / 2 + 2) % 3];
      frame.gray(x, y) = static_cast<std::uint8_t>(30 + tile_grey(wall, a, b, 0.31) + tile_grey(wall + 10, a, b, 0.13));
      frame.depth(x, y) = static_cast<float>(depth_m);
    }
  }
  return frame;
}

geometry::Pose room_path(int index) {
  const double s = 0.02 * index;
  geometry::Vector6d xi;
  xi << 1.2 * std::sin(s), 0.3 * std::sin(1.5 * s), 0.8 * (1.0 - std::cos(s)), 0.1 * std::sin(2.0 * s), -0.8 * s,
      0.05 * std::sin(s);
  return geometry::se3_exp(xi);
}

}  // namespace lapis::slam::test
