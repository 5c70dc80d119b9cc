#include "slam/core/calibration/depth_alignment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <vector>

namespace lapis::slam {
namespace {

const geometry::PinholeCamera kView{320, 240, 260.0, 260.0, 159.5, 119.5};

struct Board {
  Eigen::Vector3d centre;
  double half_m = 0.0;
  std::uint8_t gray = 0;
};

/// Boards before a wall 4 m away, all square to the view; their grey values are random, and have noise.
std::vector<Board> boards(std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::vector<Board> all;
  for (int i = 0; i < 14; ++i) {
    const double z = 1.0 + 2.0 * share(random);
    const double x = (1.2 * share(random) - 0.6) * z, y = (0.9 * share(random) - 0.45) * z;
    const auto gray = static_cast<std::uint8_t>(30.0 + 190.0 * share(random));
    all.push_back({{x, y, z}, (0.05 + 0.1 * share(random)) * z, gray});
  }
  return all;
}

const Board* nearest(const std::vector<Board>& all, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
  const Board* found = nullptr;
  for (const Board& board : all) {
    const Eigen::Vector3d p = origin + board.centre.z() * ray;
    if (std::abs(p.x() - board.centre.x()) > board.half_m || std::abs(p.y() - board.centre.y()) > board.half_m)
      continue;
    if (found == nullptr || board.centre.z() < found->centre.z()) found = &board;
  }
  return found;
}

/// Grey values at the origin, and depth of a camera at `shift_m` whose focal length is kView's over `focal_ratio`.
RgbdFrame see(const std::vector<Board>& all, const DepthOffset& offset) {
  constexpr double kWall_m = 4.0;
  constexpr std::uint8_t kWallGray = 120;
  RgbdFrame frame{
      {}, kView, geometry::GrayImage(kView.width, kView.height), geometry::DepthImage(kView.width, kView.height)};
  geometry::PinholeCamera depth_camera = kView;
  depth_camera.fx /= offset.focal_ratio;
  depth_camera.fy /= offset.focal_ratio;
  const Eigen::Vector3d origin{offset.shift_m.x(), offset.shift_m.y(), 0.0};
  std::mt19937 random(7);
  for (int v = 0; v < kView.height; ++v) {
    for (int u = 0; u < kView.width; ++u) {
      const Board* board = nearest(all, Eigen::Vector3d::Zero(), kView.unproject(u, v, 1.0));
      frame.gray(u, v) = static_cast<std::uint8_t>((board == nullptr ? kWallGray : board->gray) + random() % 9);
      board = nearest(all, origin, depth_camera.unproject(u, v, 1.0));
      frame.depth(u, v) = static_cast<float>(board == nullptr ? kWall_m : board->centre.z());
    }
  }
  return frame;
}

DepthAlignment align(const DepthOffset& truth) {
  std::vector<EdgeView> views;
  for (std::uint32_t seed = 1; seed <= 3; ++seed) views.emplace_back(see(boards(seed), truth));
  return align_depth(views);
}

TEST(DepthAlignment, FindsFocalLengthAndShift) {
  for (const DepthOffset& truth : {DepthOffset{1.0 / 1.11, {-0.025, 0.0}}, DepthOffset{1.15, {0.05, 0.005}},
                                   DepthOffset{0.97, {0.0, 0.0}}, DepthOffset{1.0, {-0.055, 0.0}}}) {
    const DepthAlignment found = align(truth);
    EXPECT_NEAR(found.offset.focal_ratio, truth.focal_ratio, 0.004);
    EXPECT_NEAR(found.offset.shift_m.x(), truth.shift_m.x(), 0.003);
    EXPECT_NEAR(found.offset.shift_m.y(), truth.shift_m.y(), 0.003);
    EXPECT_GT(found.gain_sigmas, 4.0);
    EXPECT_GT(found.moved_px, 2.0);
  }
}

TEST(DepthAlignment, LeavesRegisteredDepthWhereItIs) {
  const DepthAlignment found = align({});
  EXPECT_LT(found.moved_px, 0.5);
  EXPECT_LT(found.gain_sigmas, 4.0);
}

TEST(DepthAlignment, FindsEdgesBehindGapsWithoutDepth) {
  const auto all = boards(1);
  RgbdFrame frame = see(all, {});
  const std::size_t before = EdgeView(frame).edges().size();
  const geometry::DepthImage whole = frame.depth;
  for (int v = 0; v < kView.height; ++v) {
    for (int u = 1; u < kView.width; ++u) {
      if (whole(u, v) - whole(u - 1, v) > 0.1F) frame.depth(u, v) = 0.0F;
    }
  }
  EXPECT_NEAR(static_cast<double>(EdgeView(frame).edges().size()), static_cast<double>(before),
              0.05 * static_cast<double>(before));
}

TEST(DepthAlignment, ABareWallHasNoEdges) { EXPECT_TRUE(EdgeView(see({}, {})).edges().empty()); }

}  // namespace
}  // namespace lapis::slam
