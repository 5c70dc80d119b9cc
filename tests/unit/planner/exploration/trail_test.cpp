#include "planner/core/exploration/trail.hpp"

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

Pose2 at(double x_m) { return {{x_m, 0.0}, 0.0}; }

double next_back(const Trail& trail) { return trail.next_back().p_map.x(); }

TEST(Trail, LeadsBackFromTheNewestPoseOverPlacesApart) {
  Trail trail;
  for (const double x_m : {0.0, 0.2, 0.5, 0.6, 1.0, 1.1}) trail.add(at(x_m));
  EXPECT_EQ(trail.newest()->p_map.x(), 1.1);
  trail.turn_back();
  EXPECT_EQ(next_back(trail), 1.1);
  for (const double x_m : {1.0, 0.5, 0.0}) {
    ASSERT_TRUE(trail.step_back());
    EXPECT_EQ(next_back(trail), x_m);
  }
  EXPECT_FALSE(trail.step_back());
  EXPECT_EQ(next_back(trail), 0.0) << "the oldest stays the last resort";
}

TEST(Trail, ForgetsTheOldest) {
  Trail trail;
  for (int i = 0; i < 1000; ++i) trail.add(at(i));
  int steps = 0;
  while (trail.step_back()) ++steps;
  EXPECT_EQ(steps, 49);
  EXPECT_EQ(next_back(trail), 950.0);
}

TEST(Trail, KnowsWhereItTurnedLast) {
  Trail trail;
  EXPECT_FALSE(trail.turned_left());
  for (const double yaw_rad : {3.0, -3.2}) trail.add({{0.0, 0.0}, yaw_rad});
  EXPECT_TRUE(trail.turned_left()) << "by 0.08, across pi";
  trail.add({{1.0, 0.0}, -3.205});
  EXPECT_TRUE(trail.turned_left()) << "noise";
  trail.add({{1.0, 0.0}, -3.3});
  EXPECT_FALSE(trail.turned_left());
}

TEST(Trail, IsEmptyBeforeSlamHasTracked) {
  Trail trail;
  trail.turn_back();
  EXPECT_TRUE(trail.is_empty());
  EXPECT_FALSE(trail.newest());
}

}  // namespace
}  // namespace lapis::planner
