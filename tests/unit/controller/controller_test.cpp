#include "controller/core/controller.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/controller/kinematic_world.hpp"

namespace lapis::controller {
namespace {

using ::testing::HasSubstr;
using Path = std::vector<PlanarPose>;

constexpr double kWallHeight_m = 2.6;
Box wall(double x0, double y0, double x1, double y1) { return {{x0, y0, 0}, {x1, y1, kWallHeight_m}, 1}; }

/// Walls around 16 x 16 m.
std::vector<Box> hall() {
  return {wall(-8.3, -8, -8, 8), wall(8, -8, 8.3, 8), wall(-8, -8.3, 8, -8), wall(-8, 8, 8, 8.3)};
}

/// Between two walls, at y of -0.6 and 0.6, with a third across: the last.
std::vector<Box> closed_corridor() {
  return {wall(-3, -0.7, 2, -0.6), wall(-3, 0.6, 2, 0.7), wall(1.6, -0.6, 1.8, 0.6)};
}

std::vector<Box> with(std::vector<Box> boxes, const std::vector<Box>& more) {
  boxes.insert(boxes.end(), more.begin(), more.end());
  return boxes;
}

Path straight(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double end_yaw_rad) {
  Path path;
  for (double s = 0.0; s <= 1.0; s += 0.05) path.push_back(planar_pose(a + s * (b - a), bearing(b - a)));
  path.push_back(planar_pose(b, end_yaw_rad));
  return path;
}

double distance_to(const Path& path, const Eigen::Vector2d& p) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d a = path[i - 1].translation(), ab = path[i].translation() - a;
    const double share = ab.norm() > 0.0 ? std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (a + share * ab - p).norm());
  }
  return nearest;
}

void expect_reached(const KinematicWorld& world, const PlanarPose& goal) {
  EXPECT_EQ(world.last.reason, "the path's end is reached");
  EXPECT_LT((world.T_map_base.translation() - goal.translation()).norm(), 0.2);
  EXPECT_LT(std::abs(wrapped(yaw_of(world.T_map_base) - yaw_of(goal))), 0.2);
}

/// Drives to the end of the path; the largest distance from it [m].
double drive(KinematicWorld& world, const Path& path, double limit_s) {
  world.controller.set_path(path, "");
  double farthest_m = 0.0;
  const double took_s = world.run_until(
      [&](const Decision& decision) {
        farthest_m = std::max(farthest_m, distance_to(path, world.T_map_base.translation()));
        return decision.state != State::kFollowing;
      },
      limit_s);
  EXPECT_LE(took_s, limit_s) << world.last.reason << " at " << world.T_map_base.translation().transpose();
  EXPECT_GT(world.least_room_m, 0.0) << "touched";
  return farthest_m;
}

TEST(Controller, FollowsAStraightPathToItsEndAndHeading) {
  KinematicWorld world(hall());
  const Path path = straight({0, 0}, {4, 0}, 1.0);
  EXPECT_LT(drive(world, path, 12.0), 0.03);
  expect_reached(world, path.back());
}

TEST(Controller, FollowsACurve) {
  KinematicWorld world(hall());
  Path path;
  for (double a = 0.0; a <= 3.2; a += 0.1) path.push_back(planar_pose({1.5 * std::sin(a), 1.5 - 1.5 * std::cos(a)}, a));
  EXPECT_LT(drive(world, path, 15.0), 0.2);
  expect_reached(world, path.back());
}

TEST(Controller, TurnsOnTheSpotTowardsAPathThatBeginsBehind) {
  KinematicWorld world(hall());
  const Path path = straight({0, 0}, {-2, 0.1}, 3.1);
  EXPECT_LT(drive(world, path, 14.0), 0.3);
  expect_reached(world, path.back());
}

TEST(Controller, TurnsFirstTheWayRoundThatThePathAsksFor) {
  for (const double turn_rad : {4.0, -4.0}) {
    KinematicWorld world(hall());
    Path path;
    for (const double share : {0.3, 0.6, 0.9}) path.push_back(planar_pose({0, 0}, share * turn_rad));
    const Path away = straight({0, 0}, {2 * std::cos(turn_rad), 2 * std::sin(turn_rad)}, turn_rad);
    path.insert(path.end(), away.begin(), away.end());
    world.controller.set_path(path, "");
    double turned_rad = 0.0;
    world.run_until(
        [&, before = world.T_map_base](const Decision& decision) mutable {
          turned_rad += yaw_of(before.inverse() * world.T_map_base);
          before = world.T_map_base;
          return decision.state != State::kFollowing;
        },
        20.0);
    EXPECT_NEAR(turned_rad, turn_rad, 0.15);
    expect_reached(world, path.back());
  }
}

TEST(Controller, GoesThroughADoorAndRoundTheCorner) {
  const std::vector<Box> walls{wall(2, -8, 2.12, -0.45), wall(2, 0.45, 2.12, 8), wall(3.4, -3, 3.52, 8)};
  KinematicWorld world(with(hall(), walls));
  world.T_map_base = planar_pose({0, 0.6}, 0.0);
  Path path = straight({0, 0.6}, {1.2, 0}, 0.0);
  for (const PlanarPose& pose : straight({1.2, 0}, {2.75, 0}, 0.0)) path.push_back(pose);
  for (const PlanarPose& pose : straight({2.75, 0}, {2.75, 4}, 1.57)) path.push_back(pose);
  EXPECT_LT(drive(world, path, 25.0), 0.35);
  expect_reached(world, path.back());
}

TEST(Controller, DrivesRoundWhatThePathDoesNotKnow) {
  KinematicWorld world(
      with(hall(), {wall(-1, -1.5, 6, -1.3), wall(-1, 1.3, 6, 1.5), {{2, -0.2, 0}, {2.4, 0.25, 0.8}, 9}}));
  const Path path = straight({0, 0}, {4.5, 0}, 0.0);
  EXPECT_GT(drive(world, path, 25.0), 0.3);
  expect_reached(world, path.back());
}

// F16.
TEST(Controller, StopsForOrAvoidsWhatAppearsInFrontOfItAtFullSpeed) {
  for (const double appears_m : {0.45, 0.6, 0.9, 1.3}) {  // between the robot's disc and the thing
    KinematicWorld world(hall());
    world.controller.set_path(straight({0, 0}, {6, 0}, 0.0), "");
    ASSERT_LT(world.run_until([&](const Decision&) { return world.velocity.forward_m_s > 0.58; }, 5.0), 5.0);
    const double x = world.T_map_base.translation().x() + world.limits.radius_m + appears_m;
    world.add({{x, -0.5, 0}, {x + 0.4, 0.5, 1.1}, 9});
    world.run_until([](const Decision&) { return false; }, 6.0);
    EXPECT_GT(world.least_room_m, 0.0) << appears_m << ": touched";
  }
}

TEST(Controller, FindsAPathRoundSomethingWideThatAppearsNearIt) {
  KinematicWorld world(hall());
  const Path path = straight({0, 0}, {6, 0}, 0.0);
  world.controller.set_path(path, "");
  ASSERT_LT(world.run_until([&](const Decision&) { return world.velocity.forward_m_s > 0.58; }, 5.0), 5.0);
  const double x = world.T_map_base.translation().x() + world.limits.radius_m + 0.6;
  world.add({{x, -0.4, 0}, {x + 0.3, 0.4, 1.1}, 9});
  ASSERT_LT(world.run_until(State::kIdle, 30.0), 30.0) << world.last.reason;
  EXPECT_GT(world.least_room_m, 0.0) << "touched";
  expect_reached(world, path.back());
}

TEST(Controller, KeepsOffFeetThatNoImageHasShown) {
  for (const double side : {-1.0, 1.0}) {
    const double seen_y = 0.26 * side, foot_y = 0.19 * side, far_y = 0.8 * side;
    const auto between = [](double a, double b, double low_m, double high_m, std::uint16_t label) {
      return Box{{1.5, std::min(a, b), low_m}, {2.2, std::max(a, b), high_m}, label};
    };
    KinematicWorld world(
        with(hall(), {between(seen_y, far_y, 0.4, 1.0, 9), between(foot_y, far_y, 0.0, 0.4, KinematicWorld::kGlass)}));
    const Path path = straight({0, 0}, {4, 0}, 0.0);
    drive(world, path, 15.0);
    expect_reached(world, path.back());
  }
}

/// Steps with an operator who wants this all the time.
void steer(KinematicWorld& world, const Velocity& wanted, double duration_s) {
  for (int i = 0; i < duration_s * KinematicWorld::kRate_hz; ++i) {
    world.controller.steer(wanted, world.now);
    world.run_until([](const Decision&) { return true; }, 1.0);
  }
}

TEST(Controller, AnOperatorDrivesWithoutAPlanner) {
  KinematicWorld world(hall());
  world.has_planner = false;
  steer(world, {0.2, 0.1}, 5.0);
  EXPECT_EQ(world.last.reason, "an operator steers");
  EXPECT_NEAR(world.velocity.forward_m_s, 0.2, 0.01);
  EXPECT_NEAR(yaw_of(world.T_map_base), 0.5, 0.1);
  world.run_until([](const Decision&) { return false; }, 1.5);
  EXPECT_EQ(world.last.state, State::kIdle) << "nobody steers any more";
  EXPECT_LT(world.velocity.forward_m_s, 0.01);
}

TEST(Controller, AnOperatorCannotDriveIntoWhatTheCameraSees) {
  for (const double turn_rad_s : {0.0, 0.3, -0.3}) {
    KinematicWorld world(with(hall(), {wall(1.5, -2.0, 1.7, 2.0)}));
    steer(world, {0.6, turn_rad_s}, 12.0);
    EXPECT_GT(world.least_room_m, 0.0) << turn_rad_s << ": touched";
  }
  KinematicWorld world(with(hall(), {wall(1.5, -2.0, 1.7, 2.0)}));
  steer(world, {0.6, 0.0}, 12.0);
  EXPECT_EQ(world.last.state, State::kBlocked);
  EXPECT_GT(world.T_map_base.translation().x(), 1.0);
  steer(world, {-0.3, 0.0}, 3.0);
  EXPECT_EQ(world.last.state, State::kBlocked) << "what is behind is not known";
  world.knows_floor = true;
  const double before = world.T_map_base.translation().x();
  steer(world, {-0.3, 0.0}, 3.0);
  EXPECT_LT(world.T_map_base.translation().x(), before - 0.2);
}

TEST(Controller, AnOperatorGoesBeforeThePathAndThePathGoesOn) {
  KinematicWorld world(hall());
  const Path path = straight({0, 0}, {4, 0}, 0.0);
  world.controller.set_path(path, "");
  steer(world, {0.0, 0.5}, 2.0);
  EXPECT_GT(yaw_of(world.T_map_base), 0.7);
  EXPECT_LT(world.T_map_base.translation().norm(), 0.01);
  ASSERT_LT(world.run_until(State::kIdle, 20.0), 20.0);
  expect_reached(world, path.back());
}

TEST(Controller, WithoutAPoseAnOperatorCanOnlyTurnTheRobot) {
  KinematicWorld world(hall());
  world.has_pose = world.has_map = world.has_planner = false;
  steer(world, {0.3, 0.0}, 1.0);
  EXPECT_EQ(world.last.state, State::kStopped);
  EXPECT_THAT(world.last.reason, HasSubstr("pose"));
  steer(world, {0.0, -0.5}, 2.0);
  EXPECT_LT(yaw_of(world.T_map_base), -0.7);
  world.has_camera = false;
  world.run_until([](const Decision&) { return false; }, 0.3);
  steer(world, {0.0, -0.5}, 0.5);
  EXPECT_EQ(world.last.state, State::kStopped);
}

TEST(Controller, AccelerationStaysWithinTheRobotsLimits) {
  KinematicWorld world(with(hall(), {{{2, -0.2, 0}, {2.4, 0.2, 0.8}, 9}}));
  world.controller.set_path(straight({0, 0}, {4, 0}, 3.0), "");
  Velocity before;
  const double period_s = 1.0 / KinematicWorld::kRate_hz;
  world.run_until(
      [&](const Decision& decision) {
        if (decision.command.forward_m_s != 0.0) {  // it brakes as hard as it can
          EXPECT_LE(std::abs(decision.command.forward_m_s - before.forward_m_s),
                    world.limits.max_acceleration_m_s2 * period_s + 1e-6);
        }
        EXPECT_LE(std::abs(decision.command.turn_rad_s - before.turn_rad_s),
                  world.limits.max_turn_acceleration_rad_s2 * period_s + 1e-6);
        EXPECT_LE(std::abs(decision.command.forward_m_s), world.limits.max_speed_m_s);
        EXPECT_LE(std::abs(decision.command.turn_rad_s), world.limits.max_turn_rate_rad_s);
        before = decision.command;
        return decision.state != State::kFollowing;
      },
      25.0);
  expect_reached(world, planar_pose({4, 0}, 3.0));
}

TEST(Controller, SlowsDownBesideObstacles) {
  const auto fastest = [](const std::vector<Box>& walls) {
    KinematicWorld world(with(hall(), walls));
    world.controller.set_path(straight({0, 0}, {5, 0}, 0.0), "");
    double speed = 0.0;
    world.run_until(
        [&](const Decision& decision) {
          speed = std::max(speed, decision.command.forward_m_s);
          return decision.state != State::kFollowing;
        },
        30.0);
    return speed;
  };
  EXPECT_DOUBLE_EQ(fastest({}), 0.6);
  EXPECT_LT(fastest({wall(-1, 0.35, 7, 0.5), wall(-1, -0.5, 7, -0.35)}), 0.5);
}

TEST(Controller, ClosedPathIsWaitedForBackedUpFromAndReported) {
  KinematicWorld world(with(hall(), closed_corridor()));
  world.knows_floor = true;
  world.controller.set_path(straight({0, 0}, {5, 0}, 0.0), "");
  const auto until = [&](const std::string& reason, double limit_s) {
    return world.run_until([&](const Decision& d) { return d.reason == reason; }, limit_s);
  };
  EXPECT_LT(until("no free path: waits", 15.0), 15.0) << world.last.reason;
  EXPECT_NEAR(until("no free path: backs up", 2.0), 1.0, 0.1) << "patience";
  const Eigen::Vector2d before = world.T_map_base.translation();
  EXPECT_LT(world.run_until([](const Decision& d) { return d.command.forward_m_s >= 0.0; }, 6.0), 6.0);
  EXPECT_GT((world.T_map_base.translation() - before).norm(), 0.05) << "as far as there is room";
  EXPECT_LT(world.run_until(State::kBlocked, 15.0), 15.0) << world.last.reason;
  EXPECT_EQ(world.last.reason, "no free path along the planner's path");
  EXPECT_EQ(world.last.command.forward_m_s, 0.0);
  EXPECT_GT(world.least_room_m, 0.0) << "touched";
}

TEST(Controller, LooksAroundInsteadOfBackingUpIntoTheUnknown) {
  KinematicWorld world(with(hall(), closed_corridor()));
  world.controller.set_path(straight({0, 0}, {5, 0}, 0.0), "");
  bool has_looked = false;
  const double took_s = world.run_until(
      [&](const Decision& d) {
        EXPECT_GE(d.command.forward_m_s, 0.0);
        has_looked |= d.reason == "no free path: looks around";
        return d.state == State::kBlocked;
      },
      20.0);
  EXPECT_LT(took_s, 20.0) << world.last.reason;
  EXPECT_TRUE(has_looked);
}

// What stood so near that its lower half is below the image is believed until it is forgotten.
TEST(Controller, ContinuesWhenThePathIsFreeAgain) {
  KinematicWorld world(with(hall(), closed_corridor()));
  const Path path = straight({0, 0}, {4, 0}, 0.0);
  world.controller.set_path(path, "");
  ASSERT_LT(world.run_until(State::kBlocked, 20.0), 20.0) << world.last.reason;
  world.remove_last();
  ASSERT_LT(world.run_until(State::kFollowing, 65.0), 65.0);
  ASSERT_LT(world.run_until(State::kIdle, 20.0), 20.0) << world.last.reason;
  expect_reached(world, path.back());
}

TEST(Controller, PressedAgainstGlassItBacksUpAndThenReportsThatItIsStuck) {
  KinematicWorld world(with(hall(), {{{1.5, -3, 0}, {1.6, 3, 2}, KinematicWorld::kGlass}}));
  world.knows_floor = true;
  world.controller.set_path(straight({0, 0}, {5, 0}, 0.0), "");
  EXPECT_LT(world.run_until([](const Decision& d) { return d.command.forward_m_s < 0.0; }, 20.0), 20.0);
  EXPECT_LT(world.run_until(State::kBlocked, 40.0), 40.0) << world.last.reason;
  EXPECT_EQ(world.last.reason, "no progress, although the path looks free");
  world.controller.set_path(straight({1, 0}, {-2, 0}, 3.14), "");
  EXPECT_LT(world.run_until(State::kIdle, 20.0), 20.0) << "a new path is a new try: " << world.last.reason;
}

// A planner that repeats its path as a sign of life.
TEST(Controller, TheSamePathAgainIsContinued) {
  KinematicWorld world(hall());
  const Path path = straight({0, 0}, {4, 0}, 0.0);
  world.controller.set_path(path, "");
  world.run_until([&](const Decision&) { return world.T_map_base.translation().x() > 2.5; }, 20.0);
  for (int i = 0; i < 10; ++i) {
    world.controller.set_path(path, "");
    EXPECT_GT(world.step().command.forward_m_s, 0.3);
  }
}

TEST(Controller, NewPathReplacesTheOldOneAndAnEmptyOneStops) {
  KinematicWorld world(hall());
  world.controller.set_path(straight({0, 0}, {4, 0}, 0.0), "");
  world.run_until([](const Decision&) { return false; }, 2.0);
  EXPECT_GT(world.last.command.forward_m_s, 0.5);
  const Path back = straight({1, 0}, {1, 2}, 1.57);
  world.controller.set_path(back, "");
  ASSERT_LT(world.run_until(State::kIdle, 20.0), 20.0) << world.last.reason;
  expect_reached(world, back.back());
  world.controller.set_path(straight({1, 2}, {4, 2}, 0.0), "");
  world.run_until([](const Decision&) { return false; }, 2.0);
  world.controller.set_path({}, "enough");
  world.step();
  const Decision stop = world.step();
  EXPECT_EQ(stop.state, State::kIdle);
  EXPECT_EQ(stop.reason, "enough");
  EXPECT_EQ(stop.command.forward_m_s, 0.0);
}

TEST(Controller, WithoutAPoseItStandsStillAtOnceAndContinuesWithOne) {
  KinematicWorld world(hall());
  world.controller.set_path(straight({0, 0}, {4, 0}, 0.0), "");
  world.run_until([](const Decision&) { return false; }, 2.0);
  world.has_pose = false;
  const double stopped_s = world.run_until([](const Decision& d) { return d.command.forward_m_s == 0.0; }, 2.0);
  EXPECT_LE(stopped_s, 0.22 + 1.01 / KinematicWorld::kRate_hz);
  EXPECT_EQ(world.last.state, State::kStopped);
  EXPECT_EQ(world.last.reason, "no pose for more than 0.22 s");
  EXPECT_EQ(world.run_until([](const Decision& d) { return d.command.turn_rad_s != 0.0; }, 3.0),
            std::numeric_limits<double>::infinity())
      << "nobody has asked for a turn";
  world.has_pose = true;
  EXPECT_LT(world.run_until(State::kIdle, 20.0), 20.0) << world.last.reason;
  expect_reached(world, planar_pose({4, 0}, 0.0));
}

/// Turns by so much to the left as long as the controller wants to; what the robot itself has turned by [rad].
double turned_on_the_spot(KinematicWorld& world, double turn_rad, double limit_s) {
  world.controller.set_turn(turn_rad);
  double turned_rad = 0.0;
  PlanarPose before = world.T_map_base;
  const auto is_over = [&](const Decision& decision) {
    EXPECT_EQ(decision.command.forward_m_s, 0.0);
    turned_rad += yaw_of(before.inverse() * world.T_map_base);
    before = world.T_map_base;
    return decision.state != State::kFollowing;
  };
  EXPECT_LT(world.run_until(is_over, limit_s), limit_s) << world.last.reason;
  return turned_rad;
}

TEST(Controller, TurnsOnTheSpotWithoutPoseMapOrRoom) {
  for (const double turn_rad : {12.6, -1.0}) {
    KinematicWorld world(with(hall(), {wall(0.21, -1, 0.4, 1), wall(-0.4, -1, -0.21, 1)}));
    world.has_pose = world.has_map = false;
    EXPECT_NEAR(turned_on_the_spot(world, turn_rad, 60.0), turn_rad, 0.1);
    EXPECT_EQ(world.last.state, State::kIdle);
    EXPECT_EQ(world.last.reason, "the turn is done");
    world.controller.set_turn(turn_rad);
    EXPECT_TRUE(world.step().state == State::kIdle) << "the same turn again, by a planner that repeats itself";
  }
}

TEST(Controller, TurnsOnTheSpotSlowly) {
  ControllerConfig config;
  config.look_around_rad_s = 0.2;
  KinematicWorld world(hall(), config);
  world.controller.set_turn(3.0);
  double fastest = 0.0;
  world.run_until([&](const Decision& d) { return (fastest = std::max(fastest, d.command.turn_rad_s), false); }, 5.0);
  EXPECT_DOUBLE_EQ(fastest, 0.2);
}

TEST(Controller, ObeysLowerLimitsOnItsWay) {
  KinematicWorld world(hall());
  const Path path = straight({0, 0}, {5, 0}, 3.0);
  world.controller.set_path(path, "");
  world.run_until([](const Decision& d) { return d.command.forward_m_s == 0.6; }, 5.0);
  ControllerConfig config;
  config.speed_limit_m_s = 0.2;
  config.turn_limit_rad_s = 0.3;
  world.controller.reconfigure(config);
  double last_m_s = 0.6, fastest_turn = 0.0;
  const double took_s = world.run_until(
      [&](const Decision& d) {
        EXPECT_LE(d.command.forward_m_s, last_m_s == 0.2 ? 0.2 : std::max(0.2, last_m_s - 0.05)) << "brakes as it may";
        last_m_s = std::max(0.2, d.command.forward_m_s);
        fastest_turn = std::max(fastest_turn, std::abs(d.command.turn_rad_s));
        return d.state != State::kFollowing;
      },
      60.0);
  EXPECT_LT(took_s, 60.0);
  EXPECT_GT(took_s, 15.0) << "4 m at 0.2 m/s";
  EXPECT_LE(fastest_turn, 0.3);
  expect_reached(world, path.back());
}

TEST(Controller, TurnsSlowlyWhileViewsAreWeak) {
  for (const bool are_weak : {false, true}) {
    KinematicWorld world(hall());
    world.controller.set_weak_views(are_weak);
    world.controller.set_path(straight({0, 0}, {-1, 0}, 0.0), "");
    double fastest = 0.0;
    const auto note = [&](const Decision& d) {
      fastest = std::max(fastest, std::abs(d.command.turn_rad_s));
      return false;
    };
    world.run_until(note, 20.0);
    EXPECT_EQ(world.last.state, State::kIdle) << world.last.reason;
    EXPECT_DOUBLE_EQ(fastest, are_weak ? ControllerConfig{}.weak_turn_rad_s : RobotLimits{}.max_turn_rate_rad_s);
  }
}

TEST(Controller, ATurnWaitsForImagesAndForThePlanner) {
  for (bool KinematicWorld::*input : {&KinematicWorld::has_camera, &KinematicWorld::has_planner}) {
    KinematicWorld world(hall());
    world.has_pose = false;
    world.controller.set_turn(1.5);
    world.run_until([](const Decision&) { return false; }, 1.0);
    ASSERT_GT(world.last.command.turn_rad_s, 0.0) << world.last.reason;
    world.*input = false;
    EXPECT_LE(world.run_until(State::kStopped, 1.0), 0.22 + 1.01 / KinematicWorld::kRate_hz);
    EXPECT_EQ(world.last.command.turn_rad_s, 0.0);
    world.run_until([](const Decision&) { return false; }, 10.0);
    world.*input = true;
    EXPECT_LT(world.run_until(State::kIdle, 10.0), 10.0) << world.last.reason;
    EXPECT_NEAR(yaw_of(world.T_map_base), 1.5, 0.1) << "where it went on";
  }
}

TEST(Controller, ANewPathEndsATurnAndATurnEndsAPath) {
  KinematicWorld world(hall());
  const Path path = straight({0, 0}, {3, 0}, 0.0);
  world.controller.set_path(path, "");
  world.run_until([](const Decision&) { return false; }, 2.0);
  ASSERT_GT(world.last.command.forward_m_s, 0.5);
  world.controller.set_turn(6.0);
  EXPECT_EQ(world.step().reason, "turns on the spot");
  world.run_until([](const Decision&) { return false; }, 3.0);
  world.controller.set_path(path, "");
  EXPECT_LT(world.run_until(State::kIdle, 20.0), 20.0) << world.last.reason;
  expect_reached(world, path.back());
  world.controller.set_turn(6.0);
  EXPECT_EQ(world.step().reason, "turns on the spot") << "it is asked for anew";
}

// Slam finds itself again after half a turn: what the robot remembers is where it was in the map.
TEST(Controller, WhatIsRememberedStaysInTheMapThroughATurnWithoutAPose) {
  const Box low{{0.8, -3.0, 0.0}, {1.2, 3.0, 0.3}, 9};  // below the image from where it stops
  KinematicWorld world(with(hall(), {low}));
  world.controller.set_path(straight({-2, 0}, {0, 0}, 0.0), "");
  world.T_map_base = planar_pose({-2.0, 0.0}, 0.0);
  ASSERT_LT(world.run_until(State::kIdle, 20.0), 20.0) << world.last.reason;
  world.has_pose = false;
  turned_on_the_spot(world, 3.1, 30.0);
  world.has_pose = true;
  world.controller.set_path(straight(world.T_map_base.translation(), {3, 0}, 0.0), "");
  world.run_until([](const Decision&) { return false; }, 10.0);
  EXPECT_GT(world.least_room_m, 0.0) << "touched";
}

// A box that is below the image is known by memory alone.
TEST(Controller, WhatIsRememberedStaysInFrontOfItWhenTheMapJumps) {
  const Box low{{2.0, -3.0, 0.0}, {2.4, 3.0, 0.3}, 9};
  KinematicWorld world(with(hall(), {low}));
  world.controller.set_path(straight({0, 0}, {4, 0}, 0.0), "");
  ASSERT_LT(world.run_until([&](const Decision&) { return world.T_map_base.translation().x() > 1.1; }, 20.0), 20.0);
  world.T_published_map = planar_pose({0.5, 0.4}, 0.3);
  Path path = straight(world.T_map_base.translation(), {4, 0}, 0.0);
  for (PlanarPose& pose : path) pose = world.T_published_map * pose;
  world.controller.set_path(path, "");
  world.run_until([](const Decision&) { return false; }, 10.0);
  EXPECT_GT(world.least_room_m, 0.0);
}

TEST(Controller, StopsForAWallAlsoWhenSlamIsSlow) {
  for (const std::size_t frames : {1U, 2U, 3U}) {  // 0.07 to 0.2 s
    KinematicWorld world(with(hall(), {wall(3.0, -8, 3.2, 8)}));
    world.late_frames = frames;
    world.controller.set_path(straight({0, 0}, {6, 0}, 0.0), "");
    world.run_until([](const Decision&) { return false; }, 12.0);
    EXPECT_GT(world.T_map_base.translation().x(), 1.5) << "it has driven";
    EXPECT_GT(world.least_room_m, 0.0) << frames << ": touched";
  }
}

TEST(Controller, TheSameInputGivesTheSameCommands) {
  std::vector<Velocity> commands[2];
  for (auto& run : commands) {
    KinematicWorld world(with(hall(), {{{2, -0.2, 0}, {2.4, 0.25, 0.8}, 9}}));
    world.controller.set_path(straight({0, 0}, {4, 0}, 0.0), "");
    for (int i = 0; i < 150; ++i) run.push_back(world.step().command);
  }
  for (std::size_t i = 0; i < commands[0].size(); ++i) {
    EXPECT_EQ(commands[0][i].forward_m_s, commands[1][i].forward_m_s);
    EXPECT_EQ(commands[0][i].turn_rad_s, commands[1][i].turn_rad_s);
  }
}

}  // namespace
}  // namespace lapis::controller
