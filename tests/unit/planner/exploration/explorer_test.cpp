#include "planner/core/exploration/explorer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/core/methods/consolidation.hpp"
#include "tests/unit/planner/exploration/walk_world.hpp"

namespace lapis::planner {
namespace {

using test::WalkWorld;
using ::testing::AnyOf;
using ::testing::HasSubstr;

const std::vector<std::string> kThreeRooms = {
    "#################################",  //
    "#..........#..........#.........#",  //
    "#..........#..........#.........#",  //
    "#..........#..........#.........#",  //
    "#..R.............................",  //
    "#................................",  //
    "#................................",  //
    "#..........#..........#.........#",  //
    "#..........#..........#.........#",  //
    "#################################",
};
const std::string kGoesBack = "drives back to where slam tracked";

std::vector<std::string> closed(std::vector<std::string> lines) {
  for (std::string& line : lines) line.back() = '#';
  return lines;
}

TEST(Explorer, ExploresThreeRoomsAndIsDone) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(300.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_EQ(world.explorer.reason(), "nothing is left that can be reached");
  EXPECT_GT(world.explored_share(), 0.98);
  EXPECT_TRUE(world.explorer.path().empty());
  EXPECT_LT(world.decisions, 400);
  EXPECT_GE(world.least_decision_time_s, 0.5 - 1e-9) << "twice a second at most";
  EXPECT_FALSE(world.explorer.pause()) << "there is nothing to pause";
  EXPECT_EQ(world.explorer.state(), State::kDone);
}

TEST(Explorer, EveryMethodEnds) {
  for (const std::string& name : method_names()) {
    WalkWorld world(closed(kThreeRooms));
    world.decision_config.method = make_method(name);
    world.explorer.start();
    world.run(600.0);
    EXPECT_EQ(world.explorer.state(), State::kDone) << name << ": " << world.explorer.reason();
    EXPECT_GT(world.explored_share(), 0.95) << name;
  }
}

// As in the paper: a goal is driven to, whatever is seen on the way.
TEST(Explorer, DecidesOnlyAtGoalsWhenToldTo) {
  WalkWorld often(closed(kThreeRooms)), seldom(closed(kThreeRooms), {.replan_period_s = 0.0});
  for (WalkWorld* world : {&often, &seldom}) {
    world->explorer.start();
    world->run(300.0);
    EXPECT_EQ(world->explorer.state(), State::kDone) << world->explorer.reason();
    EXPECT_GT(world->explored_share(), 0.98);
  }
  EXPECT_LT(seldom.decisions, often.decisions);
}

TEST(Explorer, TurnsToLookAroundHoweverLittleHeadingsMatterAtGoals) {
  WalkWorld world(closed(kThreeRooms), {.goal_tolerance_m = 0.6, .goal_tolerance_rad = 3.2, .returns_home = true});
  world.explorer.start();
  double turned_rad = 0.0, before_rad = world.robot.yaw_rad;
  for (int step = 0; step < 3000 && world.explorer.state() == State::kExploring; ++step) {
    world.run(0.1);
    const bool looks = world.explorer.reason().find("looks around") != std::string::npos;
    turned_rad += looks ? turn_between(world.robot.yaw_rad, before_rad) : 0.0;
    before_rad = world.robot.yaw_rad;
  }
  EXPECT_GT(turned_rad, 3.0) << "a full turn, but for the first part";
}

TEST(Explorer, PlansHomeAgainWithoutAPeriodOfDecisions) {
  WalkWorld world(closed(kThreeRooms), {.replan_period_s = 0.0, .returns_home = true});
  const Pose2 home = world.robot;
  world.explorer.start();
  world.run(400.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_LT((world.robot.p_map - home.p_map).norm(), 0.3);
}

TEST(Explorer, DrivesHomeWhenAsked) {
  WalkWorld world(closed(kThreeRooms), {.returns_home = true});
  const Pose2 home = world.robot;
  world.explorer.start();
  world.run(400.0);
  EXPECT_EQ(world.explorer.state(), State::kDone);
  EXPECT_THAT(world.explorer.reason(), ::testing::StartsWith("is back where it started"));
  EXPECT_LT((world.robot.p_map - home.p_map).norm(), 0.3);
}

TEST(Explorer, GivesUpAFrontierBehindGlassAfterAFewTries) {
  auto lines = closed(kThreeRooms);
  for (std::string& line : lines) {
    if (line[22] == '.') line[22] = 'G';  // nobody sees it, nobody passes it
  }
  WalkWorld world(lines);
  world.explorer.start();
  world.run(600.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_GE(world.most_failures() + world.most_failed_views(), 1);
  EXPECT_LE(world.most_failures() + world.most_failed_views(), test::kMostFailures);
}

TEST(Explorer, DecidesTwiceASecondAtMostHoweverOftenItIsStarted) {
  WalkWorld world(closed(kThreeRooms));
  for (int i = 0; i < 100; ++i) {
    world.explorer.start();
    world.tick();
    EXPECT_TRUE(world.explorer.pause());
  }
  EXPECT_GT(world.decisions, 5);
  EXPECT_GE(world.least_decision_time_s, 0.5 - 1e-9);
}

TEST(Explorer, GivesUpAPlaceThatIsAlwaysBlocked) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.is_blocked = true;
  world.run(600.0);
  EXPECT_EQ(world.explorer.state(), State::kGaveUp);
  EXPECT_LT(world.decisions, 1000);
}

TEST(Explorer, AClosedRoomIsDoneAtOnce) {
  WalkWorld world({"#####", "#...#", "#.R.#", "#...#", "#####"});
  world.explorer.start();
  world.run(100.0);
  EXPECT_EQ(world.explorer.state(), State::kDone);
}

TEST(Explorer, PausesAndContinues) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(10.0);
  EXPECT_TRUE(world.explorer.pause());
  const Eigen::Vector2d place = world.robot.p_map;
  world.run(10.0);
  EXPECT_EQ(world.explorer.state(), State::kPaused);
  EXPECT_TRUE(world.explorer.path().empty());
  EXPECT_EQ(world.robot.p_map, place);
  world.explorer.start();
  world.run(300.0);
  EXPECT_EQ(world.explorer.state(), State::kDone);
}

/// Headings of a turn on the spot, each the short way from the one before, summed [rad].
double turn_of(const Explorer& explorer) {
  double turn_rad = 0.0, heading_rad = 0.0;
  for (const Pose2& pose : explorer.path()) {
    EXPECT_EQ(pose.p_map, Eigen::Vector2d(0.0, 0.0));
    turn_rad += std::remainder(pose.yaw_rad - heading_rad, 2.0 * std::numbers::pi);
    heading_rad = pose.yaw_rad;
  }
  return turn_rad;
}

TEST(Explorer, LooksAroundWhileLostAndFailsInTheEnd) {
  WalkWorld world(closed(kThreeRooms), {.lost_timeout_s = 20.0});
  world.explorer.start();
  world.run(5.0);
  world.tracking = Tracking::kLost;
  world.run(1.8);
  EXPECT_EQ(world.explorer.state(), State::kRecovering);
  EXPECT_EQ(world.explorer.reason(), "slam is lost");
  EXPECT_TRUE(world.explorer.path().empty()) << "it may be gone in a moment";
  world.run(2.0);
  EXPECT_EQ(world.explorer.reason(), "slam is lost: looks around");
  ASSERT_TRUE(world.explorer.is_turn());
  EXPECT_NEAR(std::abs(turn_of(world.explorer)), 4.0 * std::numbers::pi, 1e-9);
  const auto number = world.explorer.path_number();
  world.run(4.0);
  EXPECT_EQ(world.explorer.path_number(), number) << "one turn, not one after the other";
  world.tracking = Tracking::kTracking;
  world.run(2.0);
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  EXPECT_FALSE(world.explorer.is_turn());
  world.tracking = Tracking::kLost;
  world.run(30.0);
  EXPECT_EQ(world.explorer.state(), State::kFailed);
  EXPECT_THAT(world.explorer.reason(), HasSubstr("20 s"));
  EXPECT_TRUE(world.explorer.path().empty());
}

TEST(Explorer, ATurnEndsWhenOdometryLeadsBack) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(5.0);
  world.tracking = Tracking::kLost;
  world.run(5.0);
  ASSERT_TRUE(world.explorer.is_turn());
  world.tracking = Tracking::kDeadReckoning;
  world.drift_m = 1.0;
  world.run(0.6);
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  EXPECT_FALSE(world.explorer.is_turn());
}

TEST(Explorer, LooksAroundForTheFirstPose) {
  WalkWorld world(closed(kThreeRooms));
  world.tracking = Tracking::kLost;
  world.explorer.start();
  world.run(1.8);
  EXPECT_EQ(world.explorer.reason(), "waits for slam's first pose");
  EXPECT_TRUE(world.explorer.path().empty());
  world.run(1.0);
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  EXPECT_EQ(world.explorer.reason(), "looks around for slam's first pose");
  ASSERT_TRUE(world.explorer.is_turn());
  EXPECT_NEAR(turn_of(world.explorer), 4.0 * std::numbers::pi, 1e-9);
  world.run(10.0);
  world.tracking = Tracking::kTracking;
  world.tick();
  EXPECT_FALSE(world.explorer.is_turn());
  world.run(300.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_GT(world.explored_share(), 0.98);
}

TEST(Explorer, SaysWhatToDoWhenThereIsNoFirstPose) {
  WalkWorld world(closed(kThreeRooms), {.lost_timeout_s = 60.0});
  world.tracking = Tracking::kLost;
  for (int time = 0; time < 2; ++time) {
    world.explorer.start();
    world.run(59.0);
    EXPECT_EQ(world.explorer.state(), State::kExploring) << "each start has the same time";
    world.run(2.0);
    EXPECT_EQ(world.explorer.state(), State::kFailed);
    EXPECT_THAT(world.explorer.reason(), HasSubstr("in 60 s: move the robot to where there is something to see"));
    EXPECT_TRUE(world.explorer.path().empty());
    EXPECT_FALSE(world.explorer.is_turn());
  }
}

TEST(Explorer, ExploresByOdometryAloneAsLongAsItHasNotDriftedFar) {
  WalkWorld world(closed(kThreeRooms), {.max_drift_m = 0.5});
  world.explorer.start();
  world.run(2.0);
  world.tracking = Tracking::kDeadReckoning;
  world.drift_m = 0.1;
  world.run(8.0);
  EXPECT_EQ(world.explorer.state(), State::kExploring) << world.explorer.reason();
  EXPECT_GT(world.travelled_m, 3.0);
  world.drift_m = 0.51;
  world.run(1.0);
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  EXPECT_EQ(world.explorer.reason(), kGoesBack);
  world.tracking = Tracking::kTracking;
  world.run(300.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_GT(world.explored_share(), 0.98);
}

TEST(Explorer, DriftThatIsNoNumberIsFar) {
  WalkWorld world(closed(kThreeRooms), {.max_drift_m = 100.0});
  world.explorer.start();
  world.run(2.0);
  world.tracking = Tracking::kDeadReckoning;
  world.drift_m = std::numeric_limits<double>::quiet_NaN();
  world.run(1.0);
  EXPECT_EQ(world.explorer.reason(), kGoesBack);
}

TEST(Explorer, DrivesBackToWhereItWasTrackedWhenItHasDriftedFar) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(5.0);
  const Eigen::Vector2d place = world.robot.p_map;
  world.tick();
  world.tracking = Tracking::kDeadReckoning;
  world.drift_m = 1.0;
  world.robot.p_map += Eigen::Vector2d(0.0, -0.5);
  world.run(0.8);
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  EXPECT_EQ(world.explorer.reason(), kGoesBack);
  EXPECT_LT((world.robot.p_map - place).norm(), 0.4);
}

/// Of the map's cells, those from `column` on.
ObstacleGrid area_from(int column) {
  ObstacleGrid area{{column * WalkWorld::kResolution_m, 0.0}, WalkWorld::kResolution_m, 40, 10, {}};
  area.cells.assign(400, mapping::kFree);
  return area;
}

constexpr int kSecondRoom = 12;  // its first column

TEST(Explorer, ViewsThatWaitForACorrectionAreNotChosenAgainWhileOthersAreLeft) {
  WalkWorld world(closed(kThreeRooms));
  ASSERT_TRUE(world.surroundings.set_provisional_area(area_from(kSecondRoom)));
  world.explorer.start();
  double farthest_m = 0.0;
  while (world.explorer.reason().find("looks around") == std::string::npos && world.now.seconds() < 100.0) {
    world.tick();
    farthest_m = std::max(farthest_m, world.robot.p_map.x());
  }
  EXPECT_LT(farthest_m, kSecondRoom * WalkWorld::kResolution_m);
  world.run(400.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_GT(world.explored_share(), 0.98) << "in the end there is nothing else";
}

TEST(Explorer, DrivesBackToBeCorrectedWhenAllElseIsDone) {
  WalkWorld world(closed(kThreeRooms));
  ASSERT_TRUE(world.surroundings.set_provisional_area(area_from(kSecondRoom)));
  world.explorer.start();
  world.run(1.0);
  world.tracking = Tracking::kDeadReckoning;
  world.drift_m = 0.2;
  for (int i = 0; i < 500 && world.explorer.reason() != kGoesBack; ++i) world.tick();
  EXPECT_EQ(world.explorer.reason(), kGoesBack) << "what is left waits for the map's correction";
  world.tracking = Tracking::kTracking;
  ASSERT_TRUE(world.surroundings.set_provisional_area({}));
  world.run(400.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_GT(world.explored_share(), 0.98);
}

// In a view that shows slam nothing the robot is where it was tracked last.
TEST(Explorer, GoesBackFartherWhereItIsStillNotTracked) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(5.0);
  const double travelled_m = world.travelled_m;
  const Eigen::Vector2d place = world.robot.p_map;
  world.tracking = Tracking::kDeadReckoning;
  world.drift_m = 1.0;
  world.run(10.0);
  EXPECT_EQ(world.explorer.state(), State::kExploring) << "there is a minute for slam to track again";
  EXPECT_GT((world.robot.p_map - place).norm(), 1.0);
  EXPECT_LT(world.travelled_m, 2.0 * travelled_m + 0.5) << "along the path it came";
}

TEST(Explorer, GoesBackPastAPlaceThatItCannotGetTo) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(5.0);
  world.tracking = Tracking::kDeadReckoning;
  world.drift_m = 1.0;
  for (int i = 0; i < 10 && world.explorer.reason() != kGoesBack; ++i) world.tick();
  ASSERT_FALSE(world.explorer.path().empty());
  const Eigen::Vector2d place = world.explorer.path().back().p_map;
  world.is_blocked = true;
  world.tick();
  world.is_blocked = false;
  world.run(1.0);
  ASSERT_EQ(world.explorer.reason(), kGoesBack);
  ASSERT_FALSE(world.explorer.path().empty());
  EXPECT_GE((world.explorer.path().back().p_map - place).norm(), WalkWorld::kResolution_m) << "an earlier one";
}

TEST(Explorer, GivesUpARoomInWhichSlamDoesNotTrack) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  int losses = 0;
  const auto is_over = [&] {
    return world.explorer.state() == State::kDone || world.explorer.state() == State::kGaveUp;
  };
  while (!is_over() && world.now.seconds() < 600.0) {
    const bool is_lost = world.robot.p_map.x() > 22 * WalkWorld::kResolution_m;
    if (is_lost && world.tracking == Tracking::kTracking) ++losses;
    world.tracking = is_lost ? Tracking::kDeadReckoning : Tracking::kTracking;
    world.drift_m = is_lost ? 1.0 : 0.0;
    world.tick();
  }
  EXPECT_TRUE(is_over()) << world.explorer.reason();
  EXPECT_GT(losses, 1);
  EXPECT_LT(losses, 25);
  EXPECT_GT(world.explored_share(), 0.7);
}

TEST(Explorer, ADoorThatClosesIsNoReasonToWait) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(3.0);
  for (int y = 3; y <= 5; ++y) world.set({11, y}, '#');
  world.run(600.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
}

TEST(Explorer, SaysThatNoPathLeadsHome) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  while (world.robot.p_map.x() < 4.0 && world.explorer.state() == State::kExploring) world.run(0.2);
  ASSERT_GT(world.robot.p_map.x(), 4.0) << "it is not in the next room";
  for (int y = 3; y <= 5; ++y) world.set({11, y}, '#');
  world.explorer.return_home();
  world.run(200.0);
  EXPECT_EQ(world.explorer.state(), State::kFailed);
  EXPECT_THAT(world.explorer.reason(), AnyOf("no path back is known", "it does not get on to where it started"));
  EXPECT_TRUE(world.explorer.path().empty());
}

/// On its path back from the second room, whose door is three cells wide.
WalkWorld returning_world() {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  while (world.robot.p_map.x() < 4.0 && world.explorer.state() == State::kExploring) world.run(0.2);
  world.explorer.return_home();
  return world;
}

TEST(Explorer, SomebodyInTheDoorIsWaitedForOnThePathHome) {
  WalkWorld world = returning_world();
  for (int y = 3; y <= 5; ++y) world.set({11, y}, 'O');
  world.run(15.0);
  EXPECT_EQ(world.explorer.state(), State::kReturning) << world.explorer.reason();
  for (int y = 3; y <= 5; ++y) world.set({11, y}, '.');
  world.run(60.0);
  EXPECT_EQ(world.explorer.state(), State::kDone);
  EXPECT_EQ(world.explorer.reason(), "is back where it started");
}

TEST(Explorer, ABlockedPathHomeIsTriedAgain) {
  WalkWorld world = returning_world();
  while (world.robot.p_map.x() > 3.2 && world.explorer.state() == State::kReturning) world.run(0.2);
  world.is_blocked = true;  // by people who are gone at once
  for (int i = 0; i < 10 && !world.explorer.path().empty(); ++i) world.tick();
  world.is_blocked = false;
  ASSERT_TRUE(world.explorer.path().empty());
  world.run(60.0);
  EXPECT_EQ(world.explorer.reason(), "is back where it started");
}

// It began nearer to a wall than a planned path leads.
TEST(Explorer, ComesAsNearToHomeAsItMay) {
  auto lines = closed(kThreeRooms);
  std::swap(lines[4][3], lines[1][1]);  // 'R' into the corner
  WalkWorld world(lines, {.returns_home = true});
  world.robot.p_map += Eigen::Vector2d(-0.1, 0.1);
  const Pose2 home = world.robot;
  world.explorer.start();
  world.run(400.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_THAT(world.explorer.reason(), ::testing::StartsWith("is back where it started"));
  EXPECT_LT((world.robot.p_map - home.p_map).norm(), 1.0);
}

std::vector<std::string> six_rooms() {
  std::vector<std::string> lines = kThreeRooms;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string more = closed(kThreeRooms)[i].substr(1);
    std::replace(more.begin(), more.end(), 'R', '.');
    lines[i] += more;
  }
  return lines;
}

/// Nothing is left to explore.
WalkWorld consolidating_world(const char* by) {
  WalkWorld world(six_rooms(), {.consolidates = true});
  world.explorer.start();
  while (world.explorer.state() == State::kExploring && world.now.seconds() < 400.0) world.tick();
  world.decision_config.method = make_consolidation(by);
  return world;
}

/// In the order in which they are driven to, until all have been.
std::vector<Eigen::Vector2d> places_of_a_round(WalkWorld& world) {
  std::vector<Eigen::Vector2d> places;
  const double end_s = world.now.seconds() + 300.0;
  while (world.now.seconds() < end_s && !world.explorer.reason().starts_with("old places are visited once more")) {
    world.tick();
    const auto goal = world.explorer.memory(world.now).goal;
    if (goal && (places.empty() || (places.back() - goal->p_map).norm() > 0.5)) places.push_back(goal->p_map);
  }
  return places;
}

TEST(Explorer, DrivesThroughOldPlacesWhenNothingIsLeft) {
  std::set<std::pair<double, double>> seconds;  // places
  for (const char* by : {"nearest", "random", "lapis"}) {
    WalkWorld world = consolidating_world(by);
    ASSERT_EQ(world.explorer.state(), State::kConsolidating) << world.explorer.reason();
    const auto failures = world.explorer.failures();
    const double before_m = world.travelled_m;
    const auto places = places_of_a_round(world);
    EXPECT_EQ(world.explorer.reason(), "old places are visited once more; nothing is left that can be reached") << by;
    ASSERT_GT(places.size(), 3U) << by << ": one after the other";
    EXPECT_GT(world.travelled_m, before_m + 10.0) << by;
    EXPECT_EQ(world.explorer.failures(), failures) << by;
    for (std::size_t i = 0; i < places.size(); ++i) {
      for (std::size_t k = i + 1; k < places.size(); ++k)
        EXPECT_GT((places[i] - places[k]).norm(), 0.5) << by << ": each once, " << i << " and " << k;
    }
    seconds.insert({places[1].x(), places[1].y()});
    for (int i = 0; i < 50 && world.explorer.path().empty(); ++i) world.tick();
    EXPECT_FALSE(world.explorer.path().empty()) << by << ": another round";
    EXPECT_EQ(world.explorer.state(), State::kConsolidating);
  }
  EXPECT_GT(seconds.size(), 1U) << "they do not all choose alike";
}

TEST(Explorer, RestsWhereThereIsNoOtherOldPlace) {
  WalkWorld world({"#####", "#...#", "#.R.#", "#...#", "#####"}, {.consolidates = true});
  world.explorer.start();
  while (world.explorer.state() == State::kExploring && world.now.seconds() < 100.0) world.tick();
  world.decision_config.method = make_consolidation("nearest");
  for (int i = 0; i < 50; ++i) world.tick();
  const int before = world.decisions;
  for (int i = 0; i < 300; ++i) world.tick();
  EXPECT_EQ(world.explorer.state(), State::kConsolidating);
  EXPECT_EQ(world.explorer.reason(), "no old place can be driven to; nothing is left that can be reached");
  EXPECT_TRUE(world.explorer.path().empty());
  EXPECT_LT(world.decisions - before, 15) << "in a minute: the map may change";
}

/// Drives to an old place.
WalkWorld visiting_world() {
  WalkWorld world = consolidating_world("nearest");
  for (int i = 0; i < 50 && world.explorer.path().empty(); ++i) world.tick();
  return world;
}

TEST(Explorer, AfterALossItConsolidatesElsewhereAndExploresAMapThatIsNew) {
  WalkWorld world = visiting_world();
  const auto first = world.explorer.memory(world.now).goal;
  ASSERT_TRUE(first);
  world.tracking = Tracking::kLost;
  world.tick();
  EXPECT_EQ(world.explorer.state(), State::kRecovering);
  world.tracking = Tracking::kTracking;
  for (int i = 0; i < 20 && world.explorer.path().empty(); ++i) world.tick();
  EXPECT_EQ(world.explorer.state(), State::kConsolidating);
  ASSERT_TRUE(world.explorer.memory(world.now).goal);
  EXPECT_GT((world.explorer.memory(world.now).goal->p_map - first->p_map).norm(), 0.5) << "not where slam was lost";
  world.explorer.forget_map();
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  EXPECT_TRUE(world.explorer.memory(world.now).visited_places.empty());
}

TEST(Explorer, LeavesAnOldPlaceThatIsBlocked) {
  WalkWorld world = visiting_world();
  const auto first = world.explorer.memory(world.now).goal;
  ASSERT_TRUE(first);
  const auto failures = world.explorer.failures();
  world.is_blocked = true;
  world.tick();
  world.is_blocked = false;
  EXPECT_EQ(world.explorer.failures(), failures + 1);
  EXPECT_EQ(world.explorer.reason(), "the path was blocked; nothing is left that can be reached");
  for (int i = 0; i < 20 && !world.explorer.memory(world.now).goal; ++i) world.tick();
  ASSERT_TRUE(world.explorer.memory(world.now).goal);
  EXPECT_GT((world.explorer.memory(world.now).goal->p_map - first->p_map).norm(), 0.5);
}

TEST(Explorer, ObeysWhileItConsolidates) {
  WalkWorld world = visiting_world();
  EXPECT_TRUE(world.explorer.pause());
  EXPECT_TRUE(world.explorer.path().empty());
  world.explorer.start();
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  WalkWorld lost = visiting_world();
  lost.tracking = Tracking::kLost;
  lost.tick();
  lost.explorer.return_home();
  lost.tracking = Tracking::kTracking;
  lost.run(60.0);
  EXPECT_EQ(lost.explorer.state(), State::kDone);
  EXPECT_EQ(lost.explorer.reason(), "is back where it started; nothing is left that can be reached");
}

TEST(Explorer, PlacesOfAMapThatIsGoneAreForgotten) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(5.0);
  world.tracking = Tracking::kLost;
  world.tick();
  ASSERT_EQ(world.explorer.state(), State::kRecovering);
  world.explorer.forget_map();
  EXPECT_EQ(world.explorer.state(), State::kExploring);
  EXPECT_EQ(world.explorer.reason(), "slam has begun another map");
  EXPECT_TRUE(world.explorer.memory(world.now).left_alone.empty());
  EXPECT_FALSE(world.explorer.memory(world.now).goal);
  world.tracking = Tracking::kTracking;
  world.run(300.0);
  EXPECT_EQ(world.explorer.state(), State::kDone);
}

TEST(Explorer, ThereIsNoPathHomeIntoAMapThatIsGone) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(10.0);
  world.explorer.return_home();
  world.explorer.forget_map();
  EXPECT_EQ(world.explorer.state(), State::kFailed);
  EXPECT_EQ(world.explorer.reason(), "the map in which it started is gone");
  EXPECT_TRUE(world.explorer.path().empty());
}

TEST(Explorer, StartingOnThePathHomeStopsThePathHome) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(10.0);
  world.explorer.return_home();
  world.run(1.0);
  ASSERT_FALSE(world.explorer.path().empty());
  world.explorer.start();
  EXPECT_TRUE(world.explorer.path().empty());
  EXPECT_EQ(world.explorer.state(), State::kExploring);
}

TEST(Explorer, DrivesToAPlaceAndPausesThere) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  while (world.robot.p_map.x() < 4.0 && world.explorer.state() == State::kExploring) world.run(0.2);
  const Pose2 place{world.robot.p_map, 1.5};
  world.run(20.0);
  world.explorer.go_to({place});
  world.run(0.5);
  EXPECT_EQ(world.explorer.state(), State::kReturning);
  EXPECT_EQ(world.explorer.reason(), "drives to a place");
  world.run(60.0);
  EXPECT_EQ(world.explorer.state(), State::kPaused) << world.explorer.reason();
  EXPECT_EQ(world.explorer.reason(), "is at the place that was asked for");
  EXPECT_LT((world.robot.p_map - place.p_map).norm(), 0.35);
  EXPECT_LT(turn_between(world.robot.yaw_rad, place.yaw_rad), 0.35);
  EXPECT_TRUE(world.explorer.path().empty());
  world.explorer.start();
  world.run(300.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
}

TEST(Explorer, PausesWhereNoPathLeadsToAPlace) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(5.0);
  world.explorer.go_to({.pose = {{500.0, 500.0}, 0.0}, .has_heading = false});
  world.run(100.0);
  EXPECT_EQ(world.explorer.state(), State::kPaused);
  EXPECT_EQ(world.explorer.reason(), "no path to the place is known");
}

TEST(Explorer, KeepsToAPlaceWhileSlamIsLost) {
  WalkWorld world(closed(kThreeRooms));
  world.explorer.start();
  world.run(10.0);
  world.explorer.go_to({.pose = world.robot, .has_heading = false});
  world.tracking = Tracking::kLost;
  world.tick();
  EXPECT_EQ(world.explorer.state(), State::kRecovering);
  world.tracking = Tracking::kTracking;
  world.run(10.0);
  EXPECT_EQ(world.explorer.reason(), "is at the place that was asked for");
}

TEST(Explorer, ReturnsAlsoWhenItPlansSeldom) {
  WalkWorld world(closed(kThreeRooms), {.replan_period_s = 20.0});
  world.explorer.start();
  world.run(10.0);
  world.explorer.return_home();
  world.run(60.0);
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason();
  EXPECT_EQ(world.explorer.reason(), "is back where it started");
}

/// An explorer on a wide floor, driven by decisions and reports of the test.
class ExplorerByHand : public ::testing::Test {
 protected:
  static Candidate candidate(Eigen::Vector2d goal_map, Rejection rejection = Rejection::kNone) {
    Candidate candidate;
    candidate.frontier = 1;
    candidate.goal.p_map = candidate.target_map = goal_map;
    candidate.points = {{0.0, 0.0}, goal_map};
    candidate.path = {{{0.0, 0.0}, 0.0}, {goal_map, 0.0}};
    candidate.value.cost_m = goal_map.norm();
    candidate.rejection = rejection;
    return candidate;
  }
  static Decision towards(const Candidate& chosen) {
    Decision decision;
    decision.candidates = {chosen};
    decision.chosen = 0;
    return decision;
  }
  Report report(bool is_blocked = false) const { return {now_, robot_, Tracking::kTracking, is_blocked}; }
  bool step(bool is_blocked = false, double elapsed_s = 0.1) {
    now_ = now_ + time::Duration::from_seconds(elapsed_s);
    return explorer_.step(report(is_blocked), &surroundings_);
  }
  bool is_occupied(Eigen::Vector2d p_map) const {
    return surroundings_.grid().state(surroundings_.grid().cell_of(p_map)) == mapping::kOccupied;
  }
  /// Drives along y = `y_m` and is blocked at once.
  void be_blocked_at(double y_m) {
    robot_.p_map = {0.0, y_m};
    step();
    Candidate ahead = candidate({4.0, y_m});
    ahead.points.front() = ahead.path.front().p_map = robot_.p_map;
    explorer_.take(towards(ahead), report());
    EXPECT_TRUE(step(true, 0.5));
    EXPECT_EQ(explorer_.reason(), "the path was blocked");
  }

  Surroundings surroundings_{{}, mapping::SensorModel{}, 0.25};
  Explorer explorer_{{}};
  Pose2 robot_;
  time::Time now_;
};

TEST_F(ExplorerByHand, LooksFirstAtWhatItHasTurnedAwayFrom) {
  for (const double turn_rad : {0.05, -0.05}) {
    explorer_.start();
    for (int i = 0; i < 10; ++i) {
      robot_.yaw_rad += turn_rad;
      step();
    }
    Report lost = report();
    lost.robot.reset();
    lost.tracking = Tracking::kLost;
    while (!explorer_.is_turn()) {
      lost.now = now_ = now_ + time::Duration::from_seconds(0.1);
      explorer_.step(lost, &surroundings_);
      ASSERT_NE(explorer_.state(), State::kFailed);
    }
    EXPECT_NEAR(turn_of(explorer_), std::copysign(4.0 * std::numbers::pi, -turn_rad), 1e-9);
    step();
  }
}

TEST_F(ExplorerByHand, ADecisionFromBeforeThePathWasBlockedChangesNothing) {
  explorer_.start();
  ASSERT_TRUE(step());
  explorer_.take(towards(candidate({4.0, 0.0})), report());
  const std::uint64_t path = explorer_.path_number();
  explorer_.take(towards(candidate({0.0, 4.0})), report(true));
  EXPECT_EQ(explorer_.path_number(), path);
  EXPECT_TRUE(step(true, 0.5));
  const auto left_alone = explorer_.memory(now_).left_alone;
  ASSERT_EQ(left_alone.size(), 1U);
  EXPECT_EQ(left_alone.front().target_map, Eigen::Vector2d(4.0, 0.0)) << "the target of the path that was blocked";
}

// Frontiers that geometry closes are the end; of those tried in vain only few may be.
TEST_F(ExplorerByHand, GivesUpWhenTooMuchWasTriedInVain) {
  for (const double share_to_blame : {0.019, 0.021}) {
    explorer_.stop();
    explorer_.start();
    Decision none;
    none.leftover.length_m = {{Rejection::kUnreachable, 2.5}, {Rejection::kLeftAlone, 0.75}};
    none.leftover.share_to_blame = share_to_blame;
    while (explorer_.state() == State::kExploring) {
      if (step()) explorer_.take(none, report());
      ASSERT_LT(now_.seconds(), 200.0);
    }
    EXPECT_EQ(explorer_.state(), share_to_blame > 0.02 ? State::kGaveUp : State::kDone);
    EXPECT_THAT(explorer_.reason(), ::testing::HasSubstr("2.5 m: cannot be reached, 0.8 m: left alone for now"));
  }
  explorer_.start();
  EXPECT_EQ(explorer_.state(), State::kExploring) << "it can be asked again";
}

TEST_F(ExplorerByHand, ATargetThatOthersComeBeforeHasNotVanished) {
  explorer_.start();
  ASSERT_TRUE(step());
  explorer_.take(towards(candidate({9.0, 0.0})), report());
  Decision nearer = towards(candidate({2.0, 0.0}));
  nearer.candidates.push_back(candidate({9.0, 0.0}, Rejection::kOutranked));
  explorer_.take(nearer, report());
  EXPECT_TRUE(explorer_.memory(now_).left_alone.empty());
  explorer_.take(towards(candidate({0.0, 5.0})), report());
  EXPECT_EQ(explorer_.memory(now_).left_alone.size(), 1U) << "the one before is not there any more";
}

TEST_F(ExplorerByHand, AFrontierThatCreepsAheadIsNotLate) {
  explorer_.start();
  for (int i = 0; i < 1500; ++i) {
    robot_.p_map.x() = 0.05 * i;  // 0.5 m/s
    const bool is_wanted = step();
    ASSERT_NE(explorer_.reason(), "the path took too long") << robot_.p_map.x();
    if (is_wanted) explorer_.take(towards(candidate(robot_.p_map + Eigen::Vector2d(3.0, 0.0))), report());
  }
}

TEST_F(ExplorerByHand, ItsPathBeginsWithTheHeadingsOfTheFirstTurn) {
  explorer_.start();
  step();
  Decision decision = towards(candidate({-3.0, 0.0}));
  decision.first_turn_rad = {2.0, 3.0};
  explorer_.take(decision, report());
  const std::vector<Pose2>& path = explorer_.path();
  ASSERT_GT(path.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(path[i].p_map, Eigen::Vector2d(0.0, 0.0));
  EXPECT_EQ(path[0].yaw_rad, 2.0);
  EXPECT_EQ(path[1].yaw_rad, 3.0);
  EXPECT_EQ(explorer_.memory(now_).turns_to, 1);
  EXPECT_LT(path[3].p_map.x(), 0.0);
}

TEST_F(ExplorerByHand, GoingToAndFroBetweenTwoGoalsEnds) {
  const std::array<Candidate, 2> goals{candidate({3.0, 0.0}), candidate({-3.0, 0.0})};
  explorer_.start();
  for (int i = 0; explorer_.reason() != "the path took too long"; ++i) {
    ASSERT_LT(i, 600) << "a minute";
    robot_.p_map.x() = i / 10 % 2 == 0 ? 0.0 : 0.5;
    if (!step()) continue;
    const auto nearer = static_cast<std::size_t>(i / 10 % 2);
    Decision decision;
    decision.candidates = {goals.begin(), goals.end()};
    decision.chosen = nearer;
    explorer_.take(decision, report());
  }
  EXPECT_EQ(explorer_.memory(now_).left_alone.size(), 1U);
}

TEST_F(ExplorerByHand, ARevisitThatFailsIsGivenUpAndNoFrontierWithIt) {
  explorer_.start();
  Candidate revisit = candidate({4.0, 0.0});
  revisit.kind = CandidateKind::kRevisit;
  for (int i = 0; i < GoalMemoryConfig{}.max_failures; ++i) {
    EXPECT_TRUE(explorer_.memory(now_).old_places.empty());
    step(false, 0.5);
    explorer_.take(towards(revisit), report());
    EXPECT_TRUE(step(true, 0.5));
    EXPECT_EQ(explorer_.reason(), "the path was blocked");
    EXPECT_EQ(explorer_.memory(now_).old_places.size(), 1U);
    now_ = now_ + time::Duration::from_seconds(GoalMemoryConfig{}.expiry_s + 1.0);
  }
  EXPECT_EQ(explorer_.memory(now_).old_places.size(), 1U) << "for good";
  EXPECT_TRUE(explorer_.memory(now_).left_alone.empty());
}

TEST_F(ExplorerByHand, ACloserLookWaitsWhileAnotherFrontierIsInSight) {
  explorer_.start();
  ASSERT_TRUE(step());
  Candidate look = candidate({9.0, 0.0});
  look.kind = CandidateKind::kCloserLook;
  explorer_.take(towards(look), report());
  explorer_.take(towards(candidate({0.0, 5.0})), report());
  EXPECT_TRUE(explorer_.memory(now_).left_alone.empty());
  explorer_.take(towards(look), report());
  Candidate other = candidate({-5.0, 0.0});
  other.kind = CandidateKind::kCloserLook;
  explorer_.take(towards(other), report());
  EXPECT_EQ(explorer_.memory(now_).left_alone.size(), 2U) << "what was in sight, and what there was a look at";
}

TEST_F(ExplorerByHand, PlacesSideBySideThatStoppedItAreAllAvoidedAtOnce) {
  explorer_.start();
  be_blocked_at(0.1);
  EXPECT_TRUE(is_occupied({0.4, 0.1}));
  be_blocked_at(0.6);
  EXPECT_TRUE(is_occupied({0.4, 0.1}));
  EXPECT_TRUE(is_occupied({0.4, 0.6}));
}

TEST_F(ExplorerByHand, APathThatWasBlockedNowAndThenIsNotClosedForGood) {
  explorer_.start();
  for (int i = 0; i < 5; ++i) {
    be_blocked_at(0.1);
    EXPECT_TRUE(is_occupied({0.4, 0.1}));
    step(false, GoalMemoryConfig{}.expiry_s + 1.0);
    EXPECT_FALSE(is_occupied({0.4, 0.1})) << "whoever stood there may have gone";
  }
}

TEST_F(ExplorerByHand, WhatStoppedItIsForgottenOnThePathHome) {
  explorer_.start();
  be_blocked_at(0.1);
  explorer_.return_home();
  now_ = now_ + time::Duration::from_seconds(GoalMemoryConfig{}.expiry_s);
  step();
  EXPECT_EQ(explorer_.state(), State::kReturning) << explorer_.reason();
  EXPECT_FALSE(is_occupied({0.4, 0.1}));
}

TEST(Explorer, IdlesUntilItIsStarted) {
  WalkWorld world(closed(kThreeRooms));
  world.run(5.0);
  EXPECT_EQ(world.explorer.state(), State::kIdle);
  EXPECT_EQ(world.decisions, 0);
  world.explorer.start();
  world.run(2.0);
  world.explorer.stop();
  EXPECT_EQ(world.explorer.state(), State::kIdle);
  EXPECT_TRUE(world.explorer.path().empty());
}

}  // namespace
}  // namespace lapis::planner
