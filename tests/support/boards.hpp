#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"

namespace lapis::test {

/// A board square to the view.
struct Board {
  Eigen::Vector3d centre;
  double half_m = 0.0;
  std::uint8_t gray = 0;
};

/// Boards before a wall 4 m away, with random grey values; a seed always gives the same.
inline std::vector<Board> make_boards(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto share = [&random] { return static_cast<double>(random()) / static_cast<double>(std::mt19937::max()); };
  std::vector<Board> all;
  for (int i = 0; i < 14; ++i) {
    const double z = 1.0 + 2.0 * share();
    const double x = (1.2 * share() - 0.6) * z;
    const double y = (0.9 * share() - 0.45) * z;
    const auto gray = static_cast<std::uint8_t>(30.0 + 190.0 * share());
    all.push_back({{x, y, z}, (0.05 + 0.1 * share()) * z, gray});
  }
  return all;
}

inline const Board* nearest_board(const std::vector<Board>& boards, const Eigen::Vector3d& origin,
                                  const Eigen::Vector3d& ray) {
  const Board* found = nullptr;
  for (const Board& board : boards) {
    const Eigen::Vector3d p = origin + board.centre.z() * ray;
    const bool is_hit =
        std::abs(p.x() - board.centre.x()) <= board.half_m && std::abs(p.y() - board.centre.y()) <= board.half_m;
    if (is_hit && (found == nullptr || board.centre.z() < found->centre.z())) found = &board;
  }
  return found;
}

/// Grey values, with noise, of a camera at the origin.
inline geometry::GrayImage gray_of(const std::vector<Board>& boards, const geometry::PinholeCamera& camera) {
  constexpr std::uint8_t kWallGray = 120;
  geometry::GrayImage image(camera.width, camera.height);
  std::mt19937 random(7);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Board* board = nearest_board(boards, Eigen::Vector3d::Zero(), camera.unproject(u, v, 1.0));
      image(u, v) = static_cast<std::uint8_t>((board == nullptr ? kWallGray : board->gray) + random() % 9);
    }
  }
  return image;
}

/// Depth of a camera at `origin` that looks the same way.
inline geometry::DepthImage depth_of(const std::vector<Board>& boards, const geometry::PinholeCamera& camera,
                                     const Eigen::Vector3d& origin) {
  constexpr double kWall_m = 4.0;
  geometry::DepthImage image(camera.width, camera.height);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const Board* board = nearest_board(boards, origin, camera.unproject(u, v, 1.0));
      image(u, v) = static_cast<float>(board == nullptr ? kWall_m : board->centre.z());
    }
  }
  return image;
}

}  // namespace lapis::test
