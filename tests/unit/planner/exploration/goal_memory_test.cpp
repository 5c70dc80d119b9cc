#include "planner/core/exploration/goal_memory.hpp"

#include <gtest/gtest.h>

#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

time::Time at(double seconds) { return time::Time::from_seconds(seconds); }

// One frontier on the right of a room.
struct OneFrontier {
  OneFrontier() : frontiers({}) { frontiers.update(world.grid, world.known); }
  Eigen::Vector2d target() const { return world.grid.center_of(world.places.at('F')); }
  bool is_given_up(const GoalMemory& memory, double now_s) const {
    return !memory.given_up(world.grid, frontiers, at(now_s)).empty();
  }

  test::TextWorld world{{"#####", "#....", "#...F", "#....", "#####"}};
  FrontierMap frontiers;
};

TEST(GoalMemory, LeavesAFailureAloneUntilItExpires) {
  const OneFrontier scene;
  GoalMemory memory({.expiry_s = 30.0});
  EXPECT_FALSE(scene.is_given_up(memory, 0.0));
  memory.add_failure(scene.target(), at(10.0));
  EXPECT_TRUE(scene.is_given_up(memory, 39.0));
  EXPECT_FALSE(scene.is_given_up(memory, 41.0));
}

TEST(GoalMemory, LeavesItAloneForGoodAfterThree) {
  const OneFrontier scene;
  GoalMemory memory({.max_failures = 3});
  for (const double when : {0.0, 100.0, 200.0}) memory.add_failure(scene.target(), at(when));
  EXPECT_TRUE(scene.is_given_up(memory, 1e6));
  EXPECT_FALSE(memory.forgive());
  memory.clear();
  EXPECT_FALSE(scene.is_given_up(memory, 1e6));
}

TEST(GoalMemory, ForgivesWhatHasNotFailedForGood) {
  const OneFrontier scene;
  GoalMemory memory({});
  memory.add_failure(scene.target(), at(0.0));
  EXPECT_TRUE(memory.forgive());
  EXPECT_FALSE(scene.is_given_up(memory, 1.0));
  EXPECT_FALSE(memory.forgive()) << "nothing is left to forgive";
}

TEST(GoalMemory, RemembersPlacesNotIds) {
  const OneFrontier scene;
  GoalMemory memory({.radius_m = 0.75});
  memory.add_failure(scene.target() + Eigen::Vector2d(5.0, 0.0), at(0.0));
  EXPECT_FALSE(scene.is_given_up(memory, 1.0));
  memory.add_failure(scene.target() + Eigen::Vector2d(0.4, 0.4), at(0.0));
  EXPECT_TRUE(scene.is_given_up(memory, 1.0));
}

}  // namespace
}  // namespace lapis::planner
