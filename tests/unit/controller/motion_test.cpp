#include "controller/core/motion.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace lapis::controller {
namespace {

const RobotLimits kRobot;

TEST(StoppingSpeed, StopsWithinTheDistanceReactionIncluded) {
  for (double distance_m = 0.0; distance_m < 3.0; distance_m += 0.01) {
    const double v = stopping_speed(distance_m, kRobot);
    EXPECT_NEAR(v * kRobot.reaction_s + v * v / (2.0 * kRobot.max_acceleration_m_s2), distance_m, 1e-12);
  }
  EXPECT_EQ(stopping_speed(-1.0, kRobot), 0.0);
}

TEST(Ramped, NeverExceedsAnyLimitWhateverIsWanted) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> wanted(-5.0, 5.0), elapsed(0.0, 0.2);
  Velocity last;
  for (int i = 0; i < 10'000; ++i) {
    const double elapsed_s = elapsed(random);
    const Velocity next = ramped(last, {wanted(random), wanted(random)}, elapsed_s, kRobot);
    EXPECT_LE(std::abs(next.forward_m_s), kRobot.max_speed_m_s);
    EXPECT_LE(std::abs(next.turn_rad_s), kRobot.max_turn_rate_rad_s);
    EXPECT_LE(std::abs(next.forward_m_s - last.forward_m_s), kRobot.max_acceleration_m_s2 * elapsed_s + 1e-12);
    EXPECT_LE(std::abs(next.turn_rad_s - last.turn_rad_s), kRobot.max_turn_acceleration_rad_s2 * elapsed_s + 1e-12);
    last = next;
  }
}

TEST(Ramped, KeepsTheCurvatureWhileItSpeedsUp) {
  const Velocity next = ramped({}, {0.6, 0.6}, 0.1, kRobot);
  EXPECT_DOUBLE_EQ(next.forward_m_s, 0.15);
  EXPECT_DOUBLE_EQ(next.turn_rad_s, 0.15);
}

TEST(Ramped, BrakesAtOnceWhenItIsToStandStill) { EXPECT_EQ(ramped({0.6, 0.0}, {}, 0.05, kRobot).forward_m_s, 0.0); }

TEST(Ramped, ReachesWhatIsWanted) {
  Velocity velocity;
  for (int i = 0; i < 20; ++i) velocity = ramped(velocity, {0.5, -0.4}, 0.05, kRobot);
  EXPECT_DOUBLE_EQ(velocity.forward_m_s, 0.5);
  EXPECT_DOUBLE_EQ(velocity.turn_rad_s, -0.4);
}

}  // namespace
}  // namespace lapis::controller
