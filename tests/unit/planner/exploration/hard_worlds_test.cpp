// Worlds that break explorers. In all of them exploration ends, the robot never stands still for long before, and a
// target that cannot be had is driven to three times at most.
#include <gtest/gtest.h>

#include "tests/unit/planner/exploration/walk_world.hpp"

namespace lapis::planner {
namespace {

using test::WalkWorld;

constexpr double kLongestIdle_s = 10.0;

const std::vector<std::string> kTwoRooms = {
    "#########################################",  //
    "#..........#............................#",  //
    "#..........#............................#",  //
    "#.R.....................................#",  //
    "#.......................................#",  //
    "#.......................................#",  //
    "#..........#............................#",  //
    "#..........#............................#",  //
    "#########################################",
};

const std::vector<std::string> kFarDoor = {
    "###################################",  //
    "#...............#.................#",  //
    "#...............#.................#",  //
    "#...............#.................#",  //
    "#...............D.................#",  //
    "#..R............D.................#",  //
    "#...............D.................#",  //
    "#...............#.................#",  //
    "#...............#.................#",  //
    "#...............#.................#",  //
    "###################################",
};

class HardWorld : public testing::TestWithParam<std::string> {
 protected:
  static void start(WalkWorld& world) {
    world.decision_config.method = make_method(GetParam());
    world.explorer.start();
  }
  /// Explores until it is over; `share` of the floor is to be known then.
  static void explore(WalkWorld& world, double share, bool may_give_up = false) {
    if (world.explorer.state() == State::kIdle) start(world);
    world.run(900.0);
    const bool has_given_up = may_give_up && world.explorer.state() == State::kGaveUp;
    EXPECT_TRUE(has_given_up || world.explorer.state() == State::kDone) << world.explorer.reason();
    EXPECT_GE(world.explored_share(), share);
    EXPECT_LE(world.longest_idle_s, kLongestIdle_s);
    EXPECT_LE(world.most_failures(), test::kMostFailures);
    EXPECT_LE(world.most_failed_views(), test::kMostFailures);
    EXPECT_TRUE(world.explorer.path().empty());
  }
};

TEST_P(HardWorld, ARoomThatCannotBeEntered) {
  WalkWorld world({
      "#####################",  //
      "#.........##........#",  //
      "#.........##........#",  //
      "#.R.......W.........#",  // a hatch of one cell, seen through
      "#.........##........#",  //
      "#.........##........#",  //
      "#####################",
  });
  explore(world, 0.5, true);
}

TEST_P(HardWorld, ADoorThatLooksClosedFromAfar) {
  WalkWorld world(kFarDoor);
  explore(world, 0.98);
}

TEST_P(HardWorld, FreeSpaceBehindAGlassWall) {
  WalkWorld world({
      "#########################",  //
      "#...........W...........#",  //
      "#...........W...........#",  //
      "#.R.........W...........#",  //
      "#...........W...........#",  //
      "#...........W...........#",  //
      "#########################",
  });
  explore(world, 0.5);
}

TEST_P(HardWorld, NoiseBehindAGlassWall) {
  WalkWorld world({
      "#########################",  //
      "#...........WFFFFFFFFFFF#",  //
      "#...........WFFFFFFFFFFF#",  //
      "#.R.........WFFFFFFFFFFF#",  //
      "#...........WFFFFFFFFFFF#",  //
      "#...........WFFFFFFFFFFF#",  //
      "#########################",
  });
  explore(world, 1.0, true);
  EXPECT_LE(world.travelled_m, 60.0) << "ten times from end to end";
}

TEST_P(HardWorld, FrontiersThatGoWhenTheRobotComesAndComeBackWhenItIsAway) {
  const std::string wall(82, '#'), floor(80, '.');
  WalkWorld world({wall, '#' + floor + '#', "N.R" + floor.substr(2) + 'N', '#' + floor + '#', wall});
  explore(world, 1.0);
  EXPECT_LE(world.travelled_m, 6 * 20.0) << "a few times from end to end";
}

TEST_P(HardWorld, AClosedRoom) {
  WalkWorld world({"#######", "#.....#", "#.....#", "#..R..#", "#.....#", "#.....#", "#######"});
  explore(world, 1.0);
}

TEST_P(HardWorld, OneFrontierLeftInACorner) {
  WalkWorld world({
      "##########################",  //
      "#...............#........#",  //
      "#...............#........#",  //
      "#.R.............#........#",  //
      "#...............#........#",  //
      "#........................#",  //
      "#........................#",  //
      "#........................#",  //
      "##########################",
  });
  explore(world, 1.0);
}

TEST_P(HardWorld, AFrontierOfAQuarterMetre) {
  WalkWorld world({
      "######################",  //
      "#..........#.........#",  //
      "#..........#.........#",  //
      "#.R..................#",  // a door of 0.75 m, and behind it a niche of one cell
      "#....................#",  //
      "#....................#",  //
      "#..........#.........#",  //
      "#..........#######.###",  //
      "#..........#######.###",  //
      "######################",
  });
  explore(world, 1.0);
}

TEST_P(HardWorld, ADoorThatClosesBehindTheRobot) {
  WalkWorld world(kTwoRooms);
  start(world);
  while (world.robot.p_map.x() < 3.5 && world.explorer.state() == State::kExploring) world.run(0.2);
  ASSERT_GE(world.robot.p_map.x(), 3.5) << "it has not gone through";
  for (int y = 3; y <= 5; ++y) world.set({11, y}, '#');
  explore(world, 0.5);
}

TEST_P(HardWorld, AStartBesideAWall) {
  WalkWorld world({
      "#################",  //
      "#R..............#",  //
      "#...............#",  //
      "#...............#",  //
      "#...............#",  //
      "#...............#",  //
      "#################",
  });
  world.robot.p_map += Eigen::Vector2d(-0.1, 0.1);
  world.robot.yaw_rad = 2.4;  // it faces the corner
  explore(world, 1.0);
}

TEST_P(HardWorld, AnObstacleThatComesAndGoes) {
  WalkWorld world(kTwoRooms);
  start(world);
  world.run(2.0);
  for (int y = 3; y <= 5; ++y) world.set({11, y}, 'O');
  world.run(15.0);
  EXPECT_LT(world.robot.p_map.x(), 2.75) << "it is through";
  for (int y = 3; y <= 5; ++y) world.set({11, y}, '.');
  explore(world, 1.0);
}

TEST_P(HardWorld, AMapThatJumpsWhileTheRobotDrives) {
  WalkWorld world(kTwoRooms);
  start(world);
  for (const Cell by : {Cell{3, 1}, Cell{-2, 2}, Cell{-4, -5}}) {
    world.run(4.0);
    world.jump(by);
  }
  explore(world, 1.0);
}

// What the door is a test of.
TEST(HardWorldWithoutACloserLook, TheDoorIsNotFound) {
  WalkWorld world(kFarDoor);
  world.decision_config.closer_look_length_m = 1000.0;
  world.explorer.start();
  world.run(900.0);
  EXPECT_EQ(world.explorer.state(), State::kDone);
  EXPECT_LT(world.explored_share(), 0.8);
}

INSTANTIATE_TEST_SUITE_P(Methods, HardWorld, testing::ValuesIn(method_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace lapis::planner
