#include "simulator/core/robot/tour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "floor_plan.hpp"
#include "simulator/core/robot/tour_follower.hpp"

namespace lapis::simulator {
namespace {

constexpr double kPi = std::numbers::pi;

PathConfig shortest_only() {
  PathConfig config;
  config.nearness_weight = 0.0;
  return config;
}

double least_clearance(const NavMap& map, const Path& path) {
  double least = 1e9;
  for (std::size_t i = 1; i < path.size(); ++i) {
    for (int s = 0; s <= 100; ++s) {
      least = std::min(least, map.distance_m(path[i - 1] + (path[i] - path[i - 1]) * (s / 100.0)));
    }
  }
  return least;
}

TEST(PathPlanner, GoesStraightWhereItCan) {
  const NavMap map = map_of(8, 6, {});
  const PathPlanner planner(map, {});
  std::mt19937_64 engine(10);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector2d a(draw(engine, 0.7, 7.3), draw(engine, 0.7, 5.3));
    const Eigen::Vector2d b(draw(engine, 0.7, 7.3), draw(engine, 0.7, 5.3));
    const auto path = planner.plan(a, b);
    ASSERT_TRUE(path);
    EXPECT_EQ(path->front(), a);
    EXPECT_EQ(path->back(), b);
    EXPECT_NEAR(length_m(*path), (b - a).norm(), 0.01 * (b - a).norm() + 1e-9)
        << a.transpose() << " to " << b.transpose();
  }
}

TEST(PathPlanner, GoesTheShortestPathAroundTheEndOfAWall) {
  const NavMap map = map_of(8, 6, {{3.9, 0, 4.1, 3}});
  const auto path = PathPlanner(map, shortest_only()).plan({2, 1}, {6, 1});
  ASSERT_TRUE(path);
  // A taut string from (2, 1) around two discs of radius 0.25 m at the wall's corners to (6, 1).
  const double dx = 1.9, dy = 2.0, r = 0.25, d = std::hypot(dx, dy);
  const double tangent = std::sqrt(d * d - r * r);
  const double arc = r * (kPi / 2 - std::atan2(dy, dx) + std::asin(r / d));
  const double taut = 2 * (tangent + arc) + 0.2;
  EXPECT_GE(length_m(*path), taut - 0.05);
  EXPECT_LE(length_m(*path), 1.03 * taut);
  EXPECT_GE(least_clearance(map, *path), 0.24);
}

TEST(PathPlanner, KeepsToTheMiddleOfPassages) {
  const NavMap map = map_of(6, 4, {{2, 0, 4, 1.5}, {2, 2.5, 4, 4}});
  const auto path = PathPlanner(map, {}).plan({1, 0.8}, {5, 0.8});
  ASSERT_TRUE(path);
  EXPECT_GT(least_clearance(map, *path), 0.35) << "of 0.5 m in the middle";
}

TEST(PathPlanner, KeepsTheRobotOffObstacles) {
  std::mt19937_64 engine(12);
  int found = 0;
  for (int k = 0; k < 10; ++k) {
    std::vector<Rectangle> things;
    for (int i = 0; i < 40; ++i) {
      const double x = draw(engine, 0.8, 7.2), y = draw(engine, 0, 6);
      things.push_back({x, y, x + draw(engine, 0.05, 0.4), y + draw(engine, 0.05, 0.4)});
    }
    const NavMap map = map_of(8, 6, things);
    for (const double weight : {0.0, 2.0}) {
      PathConfig config;
      config.nearness_weight = weight;
      const auto path = PathPlanner(map, config).plan({0.4, 3}, {7.7, 3});
      if (!path) continue;
      ++found;
      EXPECT_GE(least_clearance(map, *path), config.radius_m) << "map " << k;
    }
  }
  EXPECT_GT(found, 10);
}

TEST(PathPlanner, FindsNoPathThroughWalls) {
  const NavMap map = map_of(6, 4, {{2.9, 0, 3.1, 4}});
  EXPECT_FALSE(PathPlanner(map, {}).plan({1, 2}, {5, 2}));
  EXPECT_FALSE(PathPlanner(map, {}).plan({1, 2}, {3, 2})) << "in the wall";
}

TEST(Tour, NamesTheWaypointThatCannotBeReached) {
  const NavMap map = map_of(6, 4, {{2.9, 0, 3.1, 4}});
  using testing::HasSubstr;
  const auto plan = [&](const Eigen::Vector2d& last) { plan_tour(map, {1, 2}, {{2, 2}, {1, 3}, last}, {}); };
  EXPECT_THAT(
      [&] {
        plan({5, 2});
      },
      testing::ThrowsMessage<std::runtime_error>(HasSubstr("waypoint 3 (5, 2) cannot be reached from waypoint 2")));
  EXPECT_THAT(
      [&] {
        plan({3, 2});
      },
      testing::ThrowsMessage<std::runtime_error>(HasSubstr("waypoint 3 (3, 2) is 0 m from an obstacle")));
}

/// Two furnished rooms and a corridor.
const NavMap& flat() {
  static const NavMap map = map_of(8, 6,
                                   {{0, 3, 1.5, 3.1},
                                    {2.4, 3, 5.5, 3.1},
                                    {6.4, 3, 8, 3.1},
                                    {3.9, 3, 4.0, 6},
                                    {0.3, 5, 2.2, 5.7},       // sofa
                                    {1.6, 3.9, 2.3, 4.3},     // low table
                                    {5, 4, 6.4, 4.8},         // table
                                    {4.7, 4.2, 4.95, 4.6},    // chair
                                    {7.5, 3.2, 7.95, 5.5}});  // shelf
  return map;
}

struct Drive {
  bool has_contact = false;
  bool is_finished = false;
  double duration_s = 0, length_m = 0, turned_rad = 0, fastest_turn = 0;
  std::vector<double> nearest_m;  ///< to each waypoint
};

Drive drive(const Path& waypoints, double start_yaw, double period_s, const NavMap& map = flat(),
            const TourConfig& config = {}) {
  RobotState start;
  start.position = {1, 1};
  start.yaw_rad = start_yaw;
  TourFollower follower(map, plan_tour(map, start.position, waypoints, config), config);
  Robot robot(map, RobotConfig{}, start);
  Drive out;
  out.nearest_m.assign(waypoints.size(), 1e9);
  DriveCommand late;  // commands take effect one period later, as in lock-step
  for (int k = 1; k * period_s < 600 && !follower.is_finished(); ++k) {
    const DriveCommand command = follower.command(robot.state());
    EXPECT_TRUE(robot.command(late));
    late = command;
    const Motion motion = robot.advance(time::Time::from_seconds(k * period_s));
    out.has_contact |= motion.is_in_contact;
    out.length_m += motion.distance_m;
    out.turned_rad += std::abs(motion.turn_rad);
    out.duration_s = robot.state().stamp.seconds();
    out.fastest_turn = std::max(out.fastest_turn, std::abs(motion.turn_rate_rad_s));
    for (std::size_t i = 0; i < waypoints.size(); ++i) {
      out.nearest_m[i] = std::min(out.nearest_m[i], (robot.state().position - waypoints[i]).norm());
    }
  }
  out.is_finished = follower.is_finished();
  EXPECT_EQ(follower.stalled(), "");
  return out;
}

Path grand_tour() { return {{2, 3.5}, {0.8, 4.3}, {3.2, 5.2}, {2, 2}, {6, 3.5}, {7, 5}, {4.4, 5.4}, {7, 1}}; }

class Following : public testing::TestWithParam<std::pair<double, double>> {};

TEST_P(Following, ReachesAllWaypointsWithoutContact) {
  const auto [yaw, period] = GetParam();
  const Drive result = drive(grand_tour(), yaw, period);
  EXPECT_TRUE(result.is_finished);
  EXPECT_FALSE(result.has_contact);
  EXPECT_LE(result.fastest_turn, 0.6 + 1e-9);
  for (std::size_t i = 0; i < result.nearest_m.size(); ++i)
    EXPECT_LT(result.nearest_m[i], 0.25) << "waypoint " << i + 1;
  EXPECT_LT(result.nearest_m.back(), 0.1) << "where it stops";
}

INSTANTIATE_TEST_SUITE_P(Conditions, Following,
                         testing::Values(std::pair(0.0, 1.0 / 15), std::pair(kPi, 1.0 / 15), std::pair(-2.0, 0.1),
                                         std::pair(1.5, 0.02)));

TEST(TourFollower, DoesNotCutTheCornersOfTautPaths) {
  const NavMap map = map_of(8, 6, {{3.9, 0, 4.1, 3}, {5.4, 2, 5.5, 6}});
  TourConfig config;
  config.path = shortest_only();
  const Drive result = drive({{3, 4.5}, {3.62, 2.9}, {4.7, 1}, {7, 5}, {3, 1}}, 0.0, 1.0 / 15, map, config);
  EXPECT_TRUE(result.is_finished);
  EXPECT_FALSE(result.has_contact);
}

TEST(Tour, EstimatesLengthAndDuration) {
  const Tour tour = plan_tour(flat(), {1, 1}, grand_tour(), {});
  const Drive result = drive(grand_tour(), 0.0, 1.0 / 15);
  EXPECT_NEAR(tour.length_m, result.length_m, 0.1 * result.length_m);
  EXPECT_NEAR(tour.duration_s, result.duration_s, 0.2 * result.duration_s);
}

/// The follower knows a map without the wall that stops the robot.
TEST(TourFollower, SaysWhereItIsStuck) {
  const NavMap believed = map_of(8, 6, {}), real = map_of(8, 6, {{4, 0, 4.2, 6}});
  RobotState start;
  start.position = {1, 1};
  TourFollower follower(believed, plan_tour(believed, start.position, {{3, 1}, {6, 1}}, {}), {});
  Robot robot(real, RobotConfig{}, start);
  double stopped_s = 0.0;  // since when it stands at the wall
  int k = 0;
  for (; k < 2000 && follower.stalled().empty(); ++k) {
    EXPECT_TRUE(robot.command(follower.command(robot.state())));
    if (!robot.advance(time::Time::from_seconds((k + 1) / 15.0)).is_in_contact) stopped_s = k / 15.0;
  }
  EXPECT_FALSE(follower.is_finished());
  EXPECT_NEAR(k / 15.0 - stopped_s, 20.0 + kPi / TourConfig().max_turn_rate_rad_s, 1.0);
  EXPECT_THAT(follower.stalled(),
              testing::AllOf(testing::HasSubstr("stuck at (3.8"), testing::HasSubstr("waypoint 2 (6.00, 1.00)")));
}

TEST(TourFollower, ATurnOnTheSpotIsNoStall) {
  TourConfig slow;
  slow.max_turn_rate_rad_s = 0.1;
  const Drive result = drive({{3, 1}, {1, 1}}, kPi, 1.0 / 15, flat(), slow);
  EXPECT_TRUE(result.is_finished);
}

TEST(Tour, WithoutWaypointsIsFinishedAtOnce) {
  TourFollower follower(flat(), plan_tour(flat(), {1, 1}, {}, {}), {});
  EXPECT_TRUE(follower.is_finished());
  EXPECT_EQ(follower.command({}).speed_m_s, 0.0);
}

}  // namespace
}  // namespace lapis::simulator
