#include "planner/core/exploration/trail.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

Pose2 at(double x_m) { return {{x_m, 0.0}, 0.0}; }

std::vector<double> places(const Trail& trail) {
  std::vector<double> x_m;
  for (const Pose2& pose : trail.poses()) x_m.push_back(pose.p_map.x());
  return x_m;
}

TEST(Trail, KeepsPosesApartAndTheNewest) {
  Trail trail;
  for (const double x_m : {0.0, 0.2, 0.5, 0.6, 1.0, 1.1}) trail.add(at(x_m));
  trail.turn_back();
  EXPECT_EQ(places(trail), (std::vector{0.0, 0.5, 1.0, 1.1}));
}

// Goals are centres of cells: up to 0.35 m off.
TEST(Trail, DropsTheViewThatIsMeant) {
  Trail trail;
  for (const double x_m : {0.0, 0.5, 1.0, 1.5}) trail.add(at(x_m));
  trail.add({{1.5, 0.0}, 1.0});
  trail.drop_nearest({{0.75, 0.2}, 0.0});
  EXPECT_EQ(places(trail), (std::vector{0.0, 1.0, 1.5, 1.5}));
  trail.drop_nearest({{1.4, 0.0}, 1.0});
  EXPECT_EQ(places(trail), (std::vector{0.0, 1.0, 1.5}));
  EXPECT_EQ(trail.poses().back().yaw_rad, 0.0) << "another heading is another view";
}

TEST(Trail, ForgetsTheOldest) {
  Trail trail;
  for (int i = 0; i < 1000; ++i) trail.add(at(i));
  EXPECT_EQ(trail.poses().size(), 50u);
  EXPECT_EQ(trail.poses().front().p_map.x(), 950.0);
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
  EXPECT_TRUE(trail.poses().empty());
  trail.drop_nearest(at(0.0));
}

}  // namespace
}  // namespace lapis::planner
