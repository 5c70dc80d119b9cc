#include "simulator/core/robot/robot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "floor_plan.hpp"

namespace lapis::simulator {
namespace {

using time::Duration;
using time::Time;

constexpr Duration kNever{std::numeric_limits<std::int64_t>::max() / 4};

const NavMap& hall() {
  static const NavMap map = map_of(20, 20, {}, 0.05);
  return map;
}

RobotState at(double x, double y, double yaw = 0.0) {
  RobotState state;
  state.position = {x, y};
  state.yaw_rad = yaw;
  return state;
}

RobotConfig untimed() {
  RobotConfig config;
  config.command_timeout = kNever;
  return config;
}

TEST(Robot, DrivesExactArcs) {
  RobotState start = at(10, 10, 0.3);
  start.drive = {0.5, 0.4};  // steady from the beginning
  Robot robot(hall(), untimed(), start);
  ASSERT_TRUE(robot.command({0.5, 0.4}));
  const Motion motion = robot.advance(Time::from_seconds(7.123456789));
  const double turn = 0.4 * 7.123456789, radius = 0.5 / 0.4;
  const Eigen::Vector2d center = start.position + radius * Eigen::Vector2d(-std::sin(0.3), std::cos(0.3));
  const Eigen::Vector2d end = center + radius * Eigen::Vector2d(std::sin(0.3 + turn), -std::cos(0.3 + turn));
  EXPECT_NEAR((robot.state().position - end).norm(), 0.0, 1e-9);
  EXPECT_NEAR(std::remainder(robot.state().yaw_rad - 0.3 - turn, 2 * std::numbers::pi), 0.0, 1e-9);
  EXPECT_NEAR(motion.distance_m, 0.5 * 7.123456789, 1e-9);
  EXPECT_NEAR(motion.turn_rad, turn, 1e-9);
  EXPECT_FALSE(motion.is_in_contact);
}

TEST(Robot, FollowsCommandsWithAFirstOrderLag) {
  RobotConfig config = untimed();
  config.max_acceleration_m_s2 = config.max_turn_acceleration_rad_s2 = 1e3;
  Robot robot(hall(), config, at(10, 10));
  ASSERT_TRUE(robot.command({0.6, 0.0}));
  for (int k = 1; k <= 20; ++k) {
    const Time t = Time::from_seconds(0.033 * k);
    robot.advance(t);
    const double rest = std::exp(-t.seconds() / config.lag_s);
    EXPECT_NEAR(robot.state().drive.speed_m_s, 0.6 * (1 - rest), 1e-3) << k;  // 0.6 ms of ramp
    EXPECT_NEAR(robot.state().position.x() - 10, 0.6 * (t.seconds() - config.lag_s * (1 - rest)), 1e-3) << k;
  }
}

TEST(Robot, KeepsSpeedAndAccelerationLimits) {
  const RobotConfig config = untimed();
  Robot robot(hall(), config, at(10, 10));
  std::mt19937_64 engine(7);
  DriveCommand before;
  double fastest = 0, hardest = 0;
  for (int k = 1; k <= 4000; ++k) {
    if (k % 50 == 1) {
      ASSERT_TRUE(robot.command({draw(engine, -3, 3), draw(engine, -3, 3)}));
    }
    robot.advance(Time{k * 5'000'000LL});
    const DriveCommand now = robot.state().drive;
    fastest = std::max({fastest, std::abs(now.speed_m_s) / 0.6, std::abs(now.turn_rate_rad_s) / 0.8});
    hardest = std::max({hardest, std::abs(now.speed_m_s - before.speed_m_s) / (1.5 * 0.005),
                        std::abs(now.turn_rate_rad_s - before.turn_rate_rad_s) / (4.0 * 0.005)});
    before = now;
  }
  EXPECT_LE(fastest, 1.0 + 1e-12);
  EXPECT_GE(fastest, 0.95) << "limits are reached";
  EXPECT_LE(hardest, 1.0 + 1e-9);
  EXPECT_GE(hardest, 0.999) << "limits are reached";
}

TEST(Robot, PoseDoesNotDependOnHowAnIntervalIsCut) {
  const auto drive = [](std::int64_t period) {
    Robot robot(hall(), untimed(), at(10, 10));
    double distance = 0, turn = 0;
    const std::array<DriveCommand, 3> commands{{{0.6, 0.7}, {-0.2, -0.8}, {0.5, 0.1}}};
    for (std::int64_t second = 0; second < 3; ++second) {
      EXPECT_TRUE(robot.command(commands[static_cast<std::size_t>(second)]));
      const std::int64_t end = (second + 1) * 1'000'000'000;
      for (std::int64_t t = second * 1'000'000'000; t < end;) {
        t = std::min(end, t + period);
        const Motion motion = robot.advance(Time{t});
        distance += motion.distance_m;
        turn += motion.turn_rad;
      }
    }
    return std::tuple(robot.state(), distance, turn);
  };
  const auto [state, distance, turn] = drive(1'000'000'000);
  for (const std::int64_t period : {1'000'000L, 1'234'567L, 5'000'000L, 20'000'000L, 66'666'667L}) {
    const auto [other, other_distance, other_turn] = drive(period);
    EXPECT_NEAR((state.position - other.position).norm(), 0.0, 2e-6) << period;
    EXPECT_NEAR(state.yaw_rad, other.yaw_rad, 1e-12) << period;
    EXPECT_NEAR(distance, other_distance, 1e-12) << period;
    EXPECT_NEAR(turn, other_turn, 1e-12) << period;
  }
}

TEST(Robot, AccelerationAndTurnRateAreWhatAnImuFeels) {
  RobotState start = at(10, 10);
  start.drive = {0.5, 0.4};
  start.velocity = {0.5, 0.0};
  Robot steady(hall(), untimed(), start);
  ASSERT_TRUE(steady.command({0.5, 0.4}));
  const Motion circle = steady.advance(Time{5'000'000});
  EXPECT_NEAR(circle.acceleration.x(), 0.0, 1e-9);
  EXPECT_NEAR(circle.acceleration.y(), 0.5 * 0.4, 1e-6) << "centripetal";
  EXPECT_NEAR(circle.turn_rate_rad_s, 0.4, 1e-12);

  Robot starting(hall(), untimed(), at(10, 10));
  ASSERT_TRUE(starting.command({0.6, 0.0}));
  EXPECT_NEAR(starting.advance(Time{5'000'000}).acceleration.x(), 1.5, 1e-9) << "the limit, at first";
}

TEST(Robot, StopsWithoutCommands) {
  const RobotConfig config;
  Robot robot(hall(), config, at(10, 10));
  ASSERT_TRUE(robot.command({0.6, 0.3}));
  robot.advance(Time::from_seconds(0.499));
  EXPECT_GT(robot.state().drive.speed_m_s, 0.4);
  robot.advance(Time::from_seconds(2.0));
  EXPECT_LT(robot.state().drive.speed_m_s, 1e-3);
  EXPECT_LT(robot.state().drive.turn_rate_rad_s, 1e-3);

  Robot kept(hall(), config, at(10, 10));
  for (int k = 0; k < 6; ++k) {
    ASSERT_TRUE(kept.command({0.6, 0.0}));
    kept.advance(Time::from_seconds(0.4 * (k + 1)));
  }
  EXPECT_GT(kept.state().drive.speed_m_s, 0.59) << "commands in time keep it going";
}

TEST(Robot, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const DriveCommand bad : {DriveCommand{nan, 0}, {0, nan}, {infinity, 0}, {0.3, -infinity}}) {
    Robot robot(hall(), untimed(), at(10, 10));
    ASSERT_TRUE(robot.command({0.5, 0.0}));
    robot.advance(Time::from_seconds(1));
    EXPECT_FALSE(robot.command(bad));
    robot.advance(Time::from_seconds(3));
    EXPECT_LT(std::abs(robot.state().drive.speed_m_s), 1e-3);
    EXPECT_TRUE(robot.state().position.allFinite());
  }
}

TEST(Robot, DoesNothingWhenTimeDoesNotPass) {
  Robot robot(hall(), untimed(), at(10, 10));
  ASSERT_TRUE(robot.command({0.5, 0.0}));
  robot.advance(Time::from_seconds(1));
  const RobotState before = robot.state();
  const Motion motion = robot.advance(Time::from_seconds(0.5));
  EXPECT_EQ(motion.distance_m, 0.0);
  EXPECT_EQ(robot.state().position, before.position);
  EXPECT_EQ(robot.state().stamp, before.stamp);
}

class Sliding : public testing::TestWithParam<double> {};

TEST_P(Sliding, KeepsOffTheWallAndMovesAlongIt) {
  const double angle = GetParam();  // between heading and wall
  const NavMap map = map_of(12, 4, {{0, 0, 12, 1}});
  RobotState start = at(1, 1.202, -angle);
  start.drive = {0.5, 0.0};
  Robot robot(map, untimed(), start);
  ASSERT_TRUE(robot.command({0.5, 0.0}));
  bool touched = false;
  double rolled = 0, slid = 0, push = 0;
  for (int k = 1; k <= 200; ++k) {
    const Motion motion = robot.advance(Time{k * 20'000'000LL});
    touched |= motion.is_in_contact;
    push = std::max(push, motion.push_m_s);
    rolled += motion.distance_m;
    slid += motion.slide_m;
    ASSERT_GE(map.distance_m(robot.state().position), 0.2) << k;
  }
  EXPECT_TRUE(touched);
  EXPECT_NEAR(push, 0.5 * std::sin(angle), 0.005) << "the part towards the wall";
  EXPECT_NEAR(robot.state().position.x(), 1 + 4 * 0.5 * std::cos(angle), 0.01) << "the tangential part is kept";
  EXPECT_LT(robot.state().position.y(), 1.21);
  EXPECT_NEAR(rolled, 2 * std::cos(angle) * std::cos(angle), 0.01) << "wheels see the part along the heading";
  EXPECT_NEAR(slid, 2 * std::cos(angle) * std::sin(angle), 0.01) << "and not the part across it";
}

INSTANTIATE_TEST_SUITE_P(Angles, Sliding, testing::Values(0.05, 0.4, std::numbers::pi / 4, 1.2));

TEST(Robot, StandsInFrontOfAWallAndGetsAway) {
  const NavMap map = map_of(4, 4, {});
  Robot robot(map, untimed(), at(3, 2));
  ASSERT_TRUE(robot.command({0.6, 0.0}));
  robot.advance(Time::from_seconds(4));
  const Eigen::Vector2d stop = robot.state().position;
  EXPECT_TRUE(robot.advance(Time::from_seconds(5)).is_in_contact);
  EXPECT_LT((robot.state().position - stop).norm(), 1e-3);
  EXPECT_LT(robot.state().velocity.norm(), 0.05) << "the body stands while the drives push";
  ASSERT_TRUE(robot.command({-0.3, 0.0}));
  robot.advance(Time::from_seconds(7));
  EXPECT_LT(robot.state().position.x(), stop.x() - 0.3);
}

TEST(Robot, NeverEntersObstaclesWhateverItIsAsked) {
  std::mt19937_64 engine(8);
  std::vector<Rectangle> obstacles{{1.5, 1.5, 2.5, 2.5}, {0, 2.7, 1, 2.8}, {3, 0, 3.1, 2}, {2.9, 3.0, 4, 3.1}};
  for (int i = 0; i < 12; ++i) {
    const double x = draw(engine, 0, 4), y = draw(engine, 0, 4);
    if (Rectangle{0.3, 0.3, 1.2, 1.2}.contains({x, y})) continue;
    obstacles.push_back({x, y, x + 0.1, y + 0.1});
  }
  const NavMap map = map_of(4, 4, obstacles);
  Robot robot(map, untimed(), at(0.7, 0.7));
  int contacts = 0;
  for (int k = 1; k <= 20000; ++k) {
    if (k % 40 == 1) {
      ASSERT_TRUE(robot.command({draw(engine, -0.2, 0.6), draw(engine, -0.8, 0.8)}));
    }
    if (robot.advance(Time{k * 66'666'667LL}).is_in_contact) ++contacts;
    ASSERT_GE(map.distance_m(robot.state().position), 0.2) << k;
    ASSERT_TRUE(robot.state().position.allFinite());
  }
  EXPECT_GT(contacts, 1000);
}

TEST(Robot, LeavesCornersAgain) {
  const NavMap map = map_of(4, 4, {});
  Robot robot(map, untimed(), at(1, 1, -3 * std::numbers::pi / 4));
  ASSERT_TRUE(robot.command({0.6, 0.0}));
  robot.advance(Time::from_seconds(5));
  ASSERT_LT(robot.state().position.norm(), 0.5) << "it stands in the corner";
  ASSERT_GE(map.distance_m(robot.state().position), 0.2);
  const double before = robot.state().position.norm();
  ASSERT_TRUE(robot.command({-0.6, 0.0}));
  robot.advance(Time::from_seconds(7));
  EXPECT_GT(robot.state().position.norm(), before + 0.5);
}

TEST(Robot, TheSameCommandsGiveTheSameBytes) {
  const NavMap map = map_of(3, 3, {{1.4, 1.4, 1.6, 1.6}});
  const auto drive = [&] {
    Robot robot(map, RobotConfig{}, at(0.7, 0.7));
    std::mt19937_64 engine(9);
    for (int k = 1; k <= 2000; ++k) {
      EXPECT_TRUE(robot.command({draw(engine, -0.2, 0.6), draw(engine, -0.8, 0.8)}));
      robot.advance(Time{k * 33'333'333LL});
    }
    return robot.state();
  };
  const RobotState a = drive(), b = drive();
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.yaw_rad, b.yaw_rad);
  EXPECT_EQ(a.velocity, b.velocity);
}

TEST(Robot, DoesNotStartInAnObstacle) {
  EXPECT_THAT([] { Robot(hall(), RobotConfig{}, at(0.1, 10)); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr("start pose (0.1, 10)")));
}

}  // namespace
}  // namespace lapis::simulator
