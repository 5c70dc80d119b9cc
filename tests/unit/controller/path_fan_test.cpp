#include "controller/core/path_fan.hpp"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

namespace lapis::controller {
namespace {

constexpr double kRadius_m = 0.2;
const FanConfig kConfig;

const PathFan& fan() {
  static const PathFan fan(kConfig, kRadius_m);
  return fan;
}

TEST(PathFan, PathsAreArcsOfTheirCurvatureWithEqualSteps) {
  EXPECT_EQ(fan().paths().size(), static_cast<std::size_t>(kConfig.groups * kConfig.branches));
  const auto steps = static_cast<std::size_t>(std::lround(kConfig.length_m / PathFan::kStep_m));
  for (const FanPath& path : fan().paths()) {
    ASSERT_GE(path.poses.size(), 2U);
    EXPECT_TRUE(path.poses.front().isApprox(PlanarPose::Identity()));
    EXPECT_LE(std::abs(path.curvature_per_m), kConfig.max_curvature_per_m);
    for (std::size_t i = 1; i < path.poses.size(); ++i) {
      const PlanarPose step = path.poses[i - 1].inverse() * path.poses[i];
      const double curvature = yaw_of(step) / PathFan::kStep_m;
      if (2 * i <= steps) {
        EXPECT_NEAR(curvature, path.curvature_per_m, 1e-9);
      }
      EXPECT_LE(std::abs(curvature), kConfig.max_curvature_per_m + 1e-9);
      EXPECT_NEAR(bearing(step.translation()), 0.5 * yaw_of(step), 1e-9) << "a chord halves its arc's turn";
      EXPECT_LE(std::abs(bearing(path.poses[i].translation())), kConfig.max_bearing_rad + 1e-9);
    }
  }
}

TEST(PathFan, IsSymmetricAndHasAStraightPath) {
  const auto& paths = fan().paths();
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const FanPath& mirrored = paths[paths.size() - 1 - i];
    ASSERT_EQ(mirrored.poses.size(), paths[i].poses.size());
    const Eigen::Vector2d end = paths[i].poses.back().translation();
    EXPECT_TRUE(mirrored.poses.back().translation().isApprox(Eigen::Vector2d(end.x(), -end.y()), 1e-9));
  }
  const FanPath& straight = paths[fan().path_along(0.0)];
  EXPECT_TRUE(straight.poses.back().translation().isApprox(Eigen::Vector2d(kConfig.length_m, 0.0)));
}

TEST(PathFan, PathAlongACurvatureIsTheOneThatContinuesWithIt) {
  for (const double curvature : {-2.5, -0.9, -0.2, 0.0, 0.05, 0.5, 1.1, 2.2}) {
    const FanPath& path = fan().paths()[fan().path_along(curvature)];
    EXPECT_NEAR(path.curvature_per_m, curvature, 0.25) << curvature;
  }
}

/// The rule as it is written down, for a point that is known exactly. `slack_m` makes the robot larger.
bool is_free(const FanPath& path, std::size_t poses, const Eigen::Vector2d& obstacle, double slack_m) {
  for (std::size_t i = 1; i < poses; ++i) {
    const double along = std::min(1.0, static_cast<double>(i) * PathFan::kStep_m / PathFan::kRamp_m);
    const double margin = kConfig.margin_m * (0.5 + 0.5 * along);
    const double distance = (path.poses[i].translation() - obstacle).norm();
    if (distance < kRadius_m + margin + slack_m && distance < obstacle.norm() - PathFan::kNearer_m + slack_m)
      return false;
  }
  return true;
}

TEST(PathFan, TableIsTheRuleUpToHalfACell) {
  const double half_diagonal_m = PathFan::kStep_m * std::sqrt(0.5);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-2.0, 2.0), turn(-3.1, 3.1);
  std::size_t blocked = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const double heading = turn(random);
    std::vector<Eigen::Vector2d> obstacles;
    for (int i = 0; i < 1 + trial % 5; ++i) obstacles.emplace_back(place(random), place(random));
    const auto free = fan().free_poses(obstacles, heading);
    for (std::size_t i = 0; i < free.size(); ++i) {
      const FanPath& path = fan().paths()[i];
      const auto all_free = [&](std::size_t poses, double slack_m) {
        return std::all_of(obstacles.begin(), obstacles.end(), [&](const auto& p) {
          return is_free(path, poses, Eigen::Rotation2Dd(-heading) * p, slack_m);
        });
      };
      ASSERT_TRUE(all_free(free[i], -half_diagonal_m)) << "never free where the robot would touch by more than that";
      if (free[i] == path.poses.size()) continue;
      ++blocked;
      ASSERT_FALSE(all_free(free[i] + 1U, half_diagonal_m)) << "never blocked by what is farther away";
    }
  }
  EXPECT_GT(blocked, 1000U);
}

TEST(PathFan, CentresOfCellsAreDecidedExactly) {
  std::mt19937 random(8);
  std::uniform_int_distribution<int> cell(-34, 33);
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector2d center((cell(random) + 0.5) * PathFan::kStep_m, (cell(random) + 0.5) * PathFan::kStep_m);
    const auto free = fan().free_poses(std::vector{center}, 0.0);
    for (std::size_t i = 0; i < free.size(); ++i) {
      const FanPath& path = fan().paths()[i];
      ASSERT_TRUE(is_free(path, free[i], center, 0.0));
      if (free[i] < path.poses.size()) {
        ASSERT_FALSE(is_free(path, free[i] + 1U, center, 0.0));
      }
    }
  }
}

std::vector<Eigen::Vector2d> wall_to_the_left(double y) {
  std::vector<Eigen::Vector2d> points;
  for (double x = -1.5; x < 1.5; x += 0.02) points.emplace_back(x, y);
  return points;
}

TEST(PathFan, RobotBesideAWallGetsAwayButNotIntoIt) {
  const auto free = fan().free_poses(wall_to_the_left(kRadius_m + 0.01), 0.0);
  const auto is_whole = [&](double curvature) {
    return free[fan().path_along(curvature)] == fan().paths()[fan().path_along(curvature)].poses.size();
  };
  EXPECT_TRUE(is_whole(-2.5));
  EXPECT_FALSE(is_whole(0.0));
  EXPECT_LE(free[fan().path_along(2.5)], 3U);
}

TEST(PathFan, RobotThatTouchesAWallTurnsAndGetsAway) {
  const auto free = fan().free_poses(wall_to_the_left(kRadius_m - 0.02), -1.3);
  const std::size_t straight = fan().path_along(0.0);
  EXPECT_EQ(free[straight], fan().paths()[straight].poses.size());
}

TEST(PathFan, RefusesWhatIsOutOfRangeByName) {
  const auto refused = [](auto change) {
    FanConfig config;
    change(config);
    try {
      PathFan(config, kRadius_m);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(refused([](FanConfig& c) { c.groups = 4; }), "fan: groups must be odd");
  EXPECT_EQ(refused([](FanConfig& c) { c.branches = 0; }), "fan.branches: 0 is out of range, allowed is 1 to 99");
  EXPECT_EQ(refused([](FanConfig& c) { c.length_m = 9.0; }), "fan.length_m: 9 is out of range, allowed is 0.5 to 5");
  EXPECT_EQ(refused([](FanConfig& c) { c.margin_m = -0.1; }), "fan.margin_m: -0.1 is out of range, allowed is 0 to 1");
}

}  // namespace
}  // namespace lapis::controller
