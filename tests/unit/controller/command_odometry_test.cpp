#include "controller/core/command_odometry.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace lapis::controller {
namespace {

constexpr time::Duration kPeriod{50'000'000};

time::Time time_of(int cycle) { return {1'000'000'000 + cycle * kPeriod.nanoseconds}; }

/// Brute force: the same drives by Euler's method in steps of 10 us. Commands are given every kPeriod.
PlanarPose driven(const DriveModel& model, const Velocity& first, int first_cycles, const Velocity& then, int cycles) {
  constexpr double kStep_s = 1e-5;
  const auto steps = static_cast<int>(std::lround(kPeriod.seconds() / kStep_s));
  double v = 0.0, w = 0.0, x = 0.0, y = 0.0, yaw = 0.0;
  const auto change = [&](double is, double wanted, double limit) {
    return kStep_s * std::clamp((wanted - is) / model.lag_s, -limit, limit);
  };
  for (int i = 0; i < cycles * steps; ++i) {
    const Velocity& target = i < first_cycles * steps ? first : then;
    v += change(v, target.forward_m_s, model.max_acceleration_m_s2);
    w += change(w, target.turn_rad_s, model.max_turn_acceleration_rad_s2);
    x += kStep_s * v * std::cos(yaw);
    y += kStep_s * v * std::sin(yaw);
    yaw += kStep_s * w;
  }
  return planar_pose({x, y}, yaw);
}

TEST(CommandOdometry, IsTheMotionOfDrivesThatLag) {
  const DriveModel model;
  for (const Velocity& first : {Velocity{0.6, 0.0}, Velocity{0.0, 0.8}, Velocity{0.5, -0.7}, Velocity{-0.15, 0.2}}) {
    CommandOdometry odometry(model);
    const Velocity then{0.1, 0.3};
    constexpr int kFirst = 20, kCycles = 35;
    for (int i = 0; i <= kCycles; ++i) odometry.add(i < kFirst ? first : then, time_of(i));
    const PlanarPose expected = driven(model, first, kFirst, then, kCycles);
    EXPECT_LT((odometry.T_odom_base().translation() - expected.translation()).norm(), 1e-3);
    EXPECT_NEAR(yaw_of(odometry.T_odom_base()), yaw_of(expected), 1e-3);
    EXPECT_EQ(odometry.stamp(), time_of(kCycles) + model.latency);
  }
}

TEST(CommandOdometry, ARobotThatNobodyCommandsStops) {
  const DriveModel model;
  CommandOdometry odometry(model), stopped(model);
  for (int i = 0; i < 40; ++i) {
    odometry.add({0.6, 0.0}, time_of(i));
    stopped.add({0.6, 0.0}, time_of(i));
  }
  const double before_m = stopped.T_odom_base().translation().x();
  stopped.add({0.0, 0.0}, time_of(39 + 20'000));
  const double driven_m = stopped.T_odom_base().translation().x() - before_m;
  EXPECT_GT(driven_m, 0.6 * model.command_timeout.seconds());
  EXPECT_LT(driven_m, 0.6 * model.command_timeout.seconds() + 0.6 * 0.6 / model.max_acceleration_m_s2);
  EXPECT_NEAR(stopped.velocity().forward_m_s, 0.0, 1e-9);
}

TEST(CommandOdometry, AClockThatGoesBackIsNoMotion) {
  for (const int back : {4, 1000}) {
    CommandOdometry odometry{DriveModel{}};
    for (int i = 0; i <= 40; ++i) odometry.add({0.6, 0.4}, time_of(i));
    const PlanarPose before = odometry.T_odom_base();
    odometry.add({0.6, 0.4}, time_of(40 - back));
    EXPECT_EQ(odometry.T_odom_base().matrix(), before.matrix());
    const int again =
        back == 4 ? 41 : 40 - back + 1;  // the time in between has been driven already, or was another one
    for (int i = 40 - back + 1; i <= again; ++i) odometry.add({0.6, 0.4}, time_of(i));
    EXPECT_NEAR((odometry.T_odom_base().translation() - before.translation()).norm(), 0.6 * kPeriod.seconds(), 1e-3);
  }
}

}  // namespace
}  // namespace lapis::controller
