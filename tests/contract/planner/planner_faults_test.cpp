// lapis_planner alone, with what goes wrong around it: fault tests F2, F3, F5, F6 and F17 of the project.
#include <gmock/gmock.h>

#include <sys/resource.h>

#include <csignal>
#include <limits>

#include "tests/contract/planner/planner_contract.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;
using namespace lapis_msgs::msg::PlannerStatus_Constants;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// slam ---------------------------------------------------------------------------------------------------------------

TEST_F(PlannerContract, SaysWhatSlamLacksAndLooksAroundUntilThereIsAFirstPose) {
  ASSERT_TRUE(start()) << planner->log();
  peers.reason = "no features with depth: the camera looks at a blank wall";
  ASSERT_TRUE(tick(kInitializing));
  EXPECT_EQ(state(), STATE_EXPLORING);
  EXPECT_EQ(reason(), "waits for slam's first pose; slam: " + peers.reason);
  const auto looked_after = ticks_until([this] { return turns(); }, 3.0, kInitializing);
  ASSERT_TRUE(looked_after) << reason() << planner->log();
  EXPECT_NEAR(*looked_after / kRate_hz, 2.0, 0.1);
  EXPECT_EQ(reason(), "looks around for slam's first pose; slam: " + peers.reason);
  EXPECT_EQ(paths.back().header().stamp(), messages::to_message(peers.stamp));
  peers.reason = "";
  ASSERT_TRUE(tick()) << planner->log();
  EXPECT_TRUE(stands()) << "there is a pose";
  peers.draw(kRoomWithDoor);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
}

TEST_F(PlannerContract, BeforeTheFirstFrameItSaysWhatSlamWaitsFor) {
  start_free();
  const std::string idle = "waits for slam's first pose";
  ASSERT_TRUE(wait_until([&] { return reason() == idle; })) << reason() << planner->log();
  lapis_msgs::msg::SlamStatus status;
  for (const std::string lack : {"waits for the camera's images", "waits: /camera/color/camera_info does not come"}) {
    status.reason(lack);
    const std::string expected = std::string(idle).append("; slam: ").append(lack);
    peers.slam_status.publish(status);
    ASSERT_TRUE(wait_until([&] { return reason() == expected; })) << reason() << planner->log();
  }
  ASSERT_TRUE(frames_until([&] { return reason().find("slam: ") == std::string::npos; })) << reason();
}

TEST_F(PlannerContract, WithoutAFirstPoseItSaysWhatToDo) {
  ASSERT_TRUE(start({"lost_timeout_s=4"})) << planner->log();
  peers.reason = "no features with depth: the camera looks at a blank wall";
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_FAILED; }, 5.0, kInitializing)) << reason();
  EXPECT_THAT(reason(), HasSubstr("move the robot to where there is something to see"));
  EXPECT_THAT(reason(), HasSubstr("the camera looks at a blank wall"));
  EXPECT_TRUE(stands());
}

TEST_F(PlannerContract, StandsWhileSlamIsLostLooksAroundAndContinuesAfterwards) {
  get_going();
  constexpr double kLatency_s = 3 / kRate_hz;  // a decision may be under way
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_RECOVERING; }, kLatency_s + 1 / kRate_hz, kLost))
      << reason() << planner->log();
  EXPECT_EQ(reason(), "slam is lost");
  EXPECT_TRUE(stands());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick(kLost)) << planner->log();
  EXPECT_TRUE(stands());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick(kLost)) << planner->log();
  EXPECT_TRUE(turns()) << reason();
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_EXPLORING; })) << reason();
  EXPECT_TRUE(stands());
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
}

TEST_F(PlannerContract, DrivesBackByOdometryToWhereSlamWasLastSure) {
  peers.drives = true;
  get_going();
  ASSERT_TRUE(ticks_until([this] { return (peers.position - Eigen::Vector2d(2, 2)).norm() > 0.5; })) << reason();
  const Eigen::Vector2d last_tracked = peers.position;
  peers.position.x() -= 0.5;  // a slip that only odometry knows of
  peers.drift_m = 0.6;
  const auto goes_back = [this] { return reason().starts_with("drives back to where slam tracked") && has_path(); };
  ASSERT_TRUE(ticks_until(goes_back, 4.0, kReckoning)) << reason();
  EXPECT_EQ(state(), STATE_EXPLORING);
  EXPECT_LT((goal() - last_tracked).norm(), 0.5) << "one of the places between there and the start";
}

TEST_F(PlannerContract, DrivesOnByOdometryThatHasNotDriftedFar) {
  peers.drives = true;
  get_going();
  peers.drift_m = 0.1;
  const std::size_t decisions = candidates.size();
  ASSERT_TRUE(ticks_until([&] { return candidates.size() >= decisions + 3; }, 10.0, kReckoning)) << reason();
  EXPECT_EQ(state(), STATE_EXPLORING);
  EXPECT_GT((peers.position - Eigen::Vector2d(2, 2)).norm(), 0.5);
}

TEST_F(PlannerContract, FailsWhenSlamStaysLost) {
  ASSERT_TRUE(start({"lost_timeout_s=1"})) << planner->log();
  peers.draw(kRoomWithDoor);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  const auto took = ticks_until([this] { return state() == STATE_FAILED; }, 3.0, kLost);
  ASSERT_TRUE(took) << reason() << planner->log();
  EXPECT_GE(*took, kRate_hz);
  EXPECT_EQ(reason(), "slam has not tracked for 1 s");
  EXPECT_TRUE(stands());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << planner->log();
  EXPECT_EQ(state(), STATE_FAILED) << "nobody has helped";
}

TEST_F(PlannerContract, PosesThatAreNoneAreCountedAndNeverComeOut) {
  get_going();
  const std::vector<std::function<void(nav_msgs::msg::Odometry&)>> spoil{
      [](auto& m) { m.pose().pose().position().x(kNaN); },
      [](auto& m) { m.pose().pose().orientation().w(std::numeric_limits<double>::infinity()); },
      [](auto& m) { m.pose().pose().orientation({}); }, [](auto& m) { m.pose().pose().position().y(1e300); },
      [](auto& m) { m.header().frame_id("odom"); }};
  for (std::size_t i = 0; i < 40; ++i) {
    auto message = peers.pose();
    spoil[i % spoil.size()](message);
    peers.odometry.publish(message);
    ASSERT_TRUE(tick()) << planner->log();
  }
  EXPECT_TRUE(has_path());
  for (const char* reason : {"pose dropped: pose has numbers that are not finite", "pose dropped: quaternion",
                             "pose dropped: pose is more than 10 km", "pose dropped: it is not of base_link in map"})
    EXPECT_TRUE(wait_for_count(reason)) << reason << planner->log();
}

// F2, F6: slam or the simulator was started again.
TEST_F(PlannerContract, NewSessionOfSlamIsAnotherMapEvenWhenTimeBeginsAgain) {
  get_going();
  for (int i = 0; i < 100; ++i) ASSERT_TRUE(tick()) << planner->log();
  const double volume_m3 = statuses.back().explored_volume_m3();
  ++peers.session;
  peers.frames_so_far = 0;
  ASSERT_TRUE(tick()) << planner->log();
  EXPECT_TRUE(stands()) << "the old path is of another map frame";
  EXPECT_EQ(state(), STATE_EXPLORING);
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << planner->log();
  EXPECT_TRUE(stands()) << "the old map, too";
  EXPECT_EQ(reason(), "waits for the map");
  ++peers.epoch;
  peers.draw(Drawing(kRoomWithDoor.begin() + 4, kRoomWithDoor.end()));
  ASSERT_TRUE(ticks_until([this] { return has_path(); }, 1.0)) << reason() << planner->log();
  EXPECT_NEAR(statuses.back().explored_volume_m3(), 0.75 * volume_m3, 0.01);
}

// F6: the clock of the camera is set, ahead and back, and slam's stamps with it, while the robot has a goal.
TEST_F(PlannerContract, ClockThatIsSetNeitherEndsAGoalNorTheDecisions) {
  start_free({"progress_timeout_s=600"});
  peers.draw(kRoomWithDoor);
  ASSERT_TRUE(frames_until([this] { return has_path(); })) << reason() << planner->log();
  for (const double step_s : {3600.0, -3600.0, -5.0}) {
    SCOPED_TRACE(step_s);
    peers.clock = {peers.clock.nanoseconds + time::Duration::from_seconds(step_s).nanoseconds};
    const std::size_t decisions = candidates.size();
    ASSERT_TRUE(frames_until([&] { return candidates.size() >= decisions + 3; })) << reason() << planner->log();
    EXPECT_EQ(state(), STATE_EXPLORING) << reason();
    EXPECT_TRUE(has_path()) << reason();
    EXPECT_EQ(statuses.back().failures(), 0U) << reason();
    const auto by_new_clock = [&] { return messages::from_message(statuses.back().header().stamp()) == peers.stamp; };
    EXPECT_TRUE(frames_until(by_new_clock)) << "its answers have the stamps of the source";
  }
  EXPECT_TRUE(wait_until([this] { return count_of("slam frame: the clock of its source was set") == 3.0; }))
      << planner->log();
}

TEST_F(PlannerContract, BlockedAfterTheClockWasSetBackIsNews) {
  peers.clock = time::Duration::from_seconds(3600.0);
  start_free({"replan_period_s=0", "progress_timeout_s=600"});
  peers.draw(kRoomWithTwoDoors);
  ASSERT_TRUE(frames_until([this] { return has_path(); })) << reason() << planner->log();
  peers.clock = {};
  const auto follows_clock = [this] { return messages::from_message(statuses.back().header().stamp()) == peers.stamp; };
  ASSERT_TRUE(frames_until(follows_clock)) << planner->log();
  EXPECT_EQ(statuses.back().failures(), 0U) << reason();
  peers.say_blocked();
  EXPECT_TRUE(frames_until([this] { return statuses.back().failures() > 0; })) << reason() << planner->log();
}

// The pose graph -----------------------------------------------------------------------------------------------------

class PlannerGraphFaults : public PlannerContract {
 protected:
  using Graph = lapis_msgs::msg::PoseGraph;

  void SetUp() override { ASSERT_TRUE(start({"progress_timeout_s=600"})) << planner->log(); }
  /// A good graph, a bad one, and a good one again: exploration continues, and the bad one is explained.
  void expect_explained(const std::function<void(Graph&)>& spoil, const std::string& explanation) {
    SCOPED_TRACE(explanation);
    const auto decides = [this] {
      const std::size_t before = candidates.size();
      return ticks_until([&] { return candidates.size() > before; }) && has_path();
    };
    peers.draw(kRoomWithDoor);
    peers.pose_graph.publish(peers.graph());
    ASSERT_TRUE(decides()) << reason() << planner->log();
    Graph bad = peers.graph();
    spoil(bad);
    peers.pose_graph.publish(bad);
    ASSERT_TRUE(decides() && decides()) << reason() << planner->log();
    EXPECT_TRUE(wait_for_count("pose graph dropped: " + explanation)) << planner->log();
    peers.pose_graph.publish(peers.graph());
    ASSERT_TRUE(decides() && decides()) << reason() << planner->log();
    EXPECT_GT(selected().d_optimality(), 0.0) << "loops are judged again";
  }
  const lapis_msgs::msg::Candidate& selected() const {
    const auto& all = candidates.back().candidates();
    return *std::find_if(all.begin(), all.end(), [](const auto& candidate) { return candidate.is_selected(); });
  }
};

TEST_F(PlannerGraphFaults, EdgeToAKeyframeThatIsNotThere) {
  expect_explained([](Graph& m) { m.edges().push_back(Peers::odometry_edge(4, 99)); },
                   "an edge names a key-frame that the pose graph does not have");
}

TEST_F(PlannerGraphFaults, NewestKeyframeInNoEdge) {
  expect_explained([](Graph& m) { m.edges().pop_back(); }, "the newest key-frame is not connected");
}

TEST_F(PlannerGraphFaults, NumbersThatAreNone) {
  expect_explained([](Graph& m) { m.edges()[1].information()[3] = kNaN; }, "the information of an edge is not finite");
  expect_explained([](Graph& m) { m.nodes()[2].pose().position().z(kNaN); }, "a key-frame's pose has numbers");
  expect_explained([](Graph& m) { m.nodes()[2].pose().position().z(1e200); }, "a key-frame's pose is more than 10 km");
}

TEST_F(PlannerGraphFaults, InformationThatIsNone) {
  expect_explained([](Graph& m) { m.edges()[1].information()[0] = -1e4; },
                   "the information of an edge is not positive definite");
}

TEST_F(PlannerGraphFaults, LostPieceOfTheGraphIsLeftOut) {
  peers.draw(kRoomWithDoor);
  Graph graph = peers.graph();
  graph.edges().erase(graph.edges().begin() + 1);  // 0-1, 2-3-4
  peers.pose_graph.publish(graph);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  EXPECT_GT(selected().d_optimality(), 0.0);
  EXPECT_EQ(count_of("pose graph dropped"), 0.0);
}

TEST_F(PlannerGraphFaults, LandmarksThatMakeNoSense) {
  peers.draw(kRoomWithDoor);
  lapis_msgs::msg::LandmarkTile tile;
  tile.epoch(1);
  tile.graph_version(1);
  tile.ids({1, 2});
  tile.positions({1.0f, std::numeric_limits<float>::quiet_NaN(), 1.0f});
  peers.landmarks.publish(tile);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  EXPECT_TRUE(wait_for_count("landmarks dropped")) << planner->log();
}

// The map ------------------------------------------------------------------------------------------------------------

TEST_F(PlannerContract, TilesAndMapStatesThatMakeNoSenseChangeNothing) {
  get_going();
  lapis_msgs::msg::VoxelTile tile;
  tile.x(1);
  tile.epoch(peers.epoch);
  tile.version(1'000);
  tile.data({'L', 1, 1, 0, 42});
  peers.tiles.publish(tile);
  auto state = peers.state();
  state.version(1'001);
  for (const double resolution_m : {kNaN, 0.0, 1e9}) {
    state.resolution_m(resolution_m);
    peers.map_state.publish(state);
    ASSERT_TRUE(tick()) << planner->log();
  }
  const double volume_m3 = statuses.back().explored_volume_m3();
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(tick()) << planner->log();
  EXPECT_TRUE(has_path());
  EXPECT_EQ(statuses.back().explored_volume_m3(), volume_m3);
  EXPECT_TRUE(wait_for_count("tile dropped: it cannot be decoded")) << planner->log();
  EXPECT_TRUE(wait_for_count("map state dropped: no map has voxels of that size")) << planner->log();
}

TEST_F(PlannerContract, MapOfAnEarlierMapperIsNotBelievedAndThatOfALaterOneReplacesIt) {
  get_going();
  const double volume_m3 = statuses.back().explored_volume_m3();
  const auto ticks = [this] {
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << planner->log();
  };
  const Drawing half(kRoomWithDoor.begin() + 8, kRoomWithDoor.end());
  peers.epoch = 4;
  peers.draw(half);
  ticks();
  EXPECT_EQ(statuses.back().explored_volume_m3(), volume_m3);
  peers.epoch = 6;
  peers.draw(half);
  ticks();
  EXPECT_NEAR(statuses.back().explored_volume_m3(), 0.5 * volume_m3, 0.01) << "nothing is left of the old map";
}

TEST_F(PlannerContract, GridsThatMakeNoSenseAreCounted) {
  get_going();
  std::vector<nav_msgs::msg::OccupancyGrid> grids(4, peers.free_grid());
  grids[0].info().width(5);
  grids[1].info().resolution(std::numeric_limits<float>::quiet_NaN());
  grids[2].info().origin().position().x(kNaN);
  grids[3].info().origin().orientation().w(0.0);
  grids[3].info().origin().orientation().x(1.0);
  for (const auto& grid : grids) {
    peers.obstacles.publish(grid);
    ASSERT_TRUE(tick()) << planner->log();
    const std::size_t before = candidates.size();  // taken over with the next decision
    ASSERT_TRUE(ticks_until([&] { return candidates.size() > before; })) << planner->log();
  }
  EXPECT_TRUE(has_path());
  for (const char* reason : {"grid has not width x height cells", "resolution or size", "origin of the grid", "turned"})
    EXPECT_TRUE(wait_for_count(reason)) << reason << planner->log();
}

TEST_F(PlannerContract, ObstacleThatIsPutOnThePathMovesOrEmptiesIt) {
  get_going();
  auto grid = peers.free_grid();  // a wall right through the room, in front of the robot
  grid.info().width(1);
  grid.info().height(16);
  grid.info().origin().position().x(3.25);
  grid.data().assign(16, 100);
  grid.header(messages::header(peers.stamp, "map"));
  peers.obstacles.publish(grid);
  ASSERT_TRUE(ticks_until([this] { return stands() || goal().x() < 3.25; }, 2.0)) << reason() << planner->log();
}

// What the mapper says of the first frame may come before slam's word that it is one of another session.
TEST_F(PlannerContract, ObstaclesThatOvertakeTheFirstFrameOfAMapCount) {
  ASSERT_TRUE(start()) << planner->log();
  peers.draw(kRoomWithDoor);
  auto grid = peers.free_grid();  // a wall right through the room, between the robot and the door
  grid.info().width(1);
  grid.info().height(16);
  grid.info().origin().position().x(3.25);
  grid.data().assign(16, 100);
  grid.header(messages::header(peers.stamp + time::Duration::from_seconds(1.0 / kRate_hz), "map"));
  peers.obstacles.publish(grid);
  ASSERT_TRUE(ticks_until([this] { return !candidates.empty(); })) << reason() << planner->log();
  for (const auto& candidate : candidates.front().candidates()) {
    EXPECT_FALSE(candidate.is_selected() && candidate.goal().position().x() > 3.25) << "through the wall";
  }
}

TEST_F(PlannerContract, WhatWaitsForACorrectionIsLeftAloneAsLongAsAnythingElseIsLeft) {
  ASSERT_TRUE(start()) << planner->log();
  auto area = peers.free_grid();  // behind the door on the right
  area.info().width(8);
  area.info().height(16);
  area.info().origin().position().x(5.0);
  area.data().assign(128, 0);
  peers.provisional_area.publish(area);
  peers.draw(kRoomWithTwoDoors);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  EXPECT_LT(goal().x(), 2.5) << "the other door" << planner->log();
  const auto is_left_alone = [this] {
    const auto& all = candidates.back().candidates();
    return std::any_of(all.begin(), all.end(), [](const auto& c) { return c.reason() == "left alone for now"; });
  };
  EXPECT_TRUE(is_left_alone());
  area.info().width(0);
  area.data().clear();
  peers.provisional_area.publish(area);
  ASSERT_TRUE(ticks_until([&] { return !is_left_alone(); }, 4.0)) << reason();
  area.header().frame_id("odom");
  peers.provisional_area.publish(area);
  ASSERT_TRUE(tick());
  EXPECT_TRUE(wait_for_count("provisional area dropped: it is not in map")) << planner->log();
}

// The controller -----------------------------------------------------------------------------------------------------

TEST_F(PlannerContract, BlockedControllerGetsAnotherGoal) {
  ASSERT_TRUE(start()) << planner->log();
  peers.draw(kRoomWithTwoDoors);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  const bool went_right = goal().x() > 2.5;
  ASSERT_TRUE(tick());
  peers.say_blocked();
  ASSERT_TRUE(ticks_until([this] { return stands(); }, 1.0)) << reason() << planner->log();
  EXPECT_EQ(reason(), "the path was blocked");
  peers.controller.publish({});
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  EXPECT_NE(goal().x() > 2.5, went_right) << "the other door";
  const auto& all = candidates.back().candidates();
  EXPECT_TRUE(std::any_of(all.begin(), all.end(), [](const auto& c) { return c.reason() == "left alone for now"; }));
}

TEST_F(PlannerContract, GoalThatIsAlwaysBlockedIsGivenUp) {
  get_going();
  std::vector<Eigen::Vector2d> goals;
  for (int i = 0; i < 60 * kRate_hz && state() != STATE_GAVE_UP; ++i) {
    if (has_path()) {
      if ((goal() - peers.position).norm() > 0.3) goals.push_back(goal());  // else it looks around
      ASSERT_TRUE(tick());
      peers.say_blocked();
      ASSERT_TRUE(ticks_until([this] { return !has_path(); }, 1.0)) << reason() << planner->log();
    }
    ASSERT_TRUE(tick()) << planner->log();
  }
  EXPECT_EQ(state(), STATE_GAVE_UP) << reason();
  EXPECT_GE(goals.size(), 3U) << "a goal is tried again";
  EXPECT_LE(goals.size(), 6U) << "but not for ever; the door is 0.75 m wide: two targets at most";
}

TEST_F(PlannerContract, BlockedOnAnOlderPathIsNoNews) {
  get_going();
  lapis_msgs::msg::ControllerStatus old;
  old.header(messages::header(messages::from_message(paths.back().header().stamp()), "map"));
  old.state(lapis_msgs::msg::ControllerStatus_Constants::STATE_BLOCKED);
  peers.controller.publish(old);
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(tick()) << planner->log();
    ASSERT_TRUE(has_path());
  }
}

TEST_F(PlannerContract, RobotThatDoesNotMoveGivesItsGoalUp) {
  ASSERT_TRUE(start({"progress_timeout_s=2"})) << planner->log();
  peers.draw(kRoomWithTwoDoors);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  const bool went_right = goal().x() > 2.5;
  ASSERT_TRUE(ticks_until([&] { return has_path() && (goal().x() > 2.5) != went_right; }, 4.0))
      << reason() << planner->log();
}

// F3 -----------------------------------------------------------------------------------------------------------------

TEST_F(PlannerContract, FullDiskCostsTheFileAndNotTheExploration) {
  const TemporaryFolder folder;
  ASSERT_TRUE(start({"output_dir=" + folder.path().string()})) << planner->log();
  const rlimit full{400, 400};  // the headings and not much more
  ASSERT_EQ(prlimit(planner->pid(), RLIMIT_FSIZE, &full, nullptr), 0);
  peers.draw(kRoomWithDoor);
  ASSERT_TRUE(ticks_until([this] { return candidates.size() == 3; })) << planner->log();
  EXPECT_TRUE(has_path());
  const std::string complaint = folder.path().string() + "/decisions.csv cannot be written";
  EXPECT_TRUE(wait_until([&] { return planner->log().find(complaint) != std::string::npos; })) << planner->log();
}

// F2 -----------------------------------------------------------------------------------------------------------------

TEST_F(PlannerContract, RestartedPlannerHasTheWholeMapAndContinues) {
  start_free();
  peers.draw(kRoomWithDoor);
  peers.pose_graph.publish(peers.graph());
  const auto volume_m3 = [this] { return statuses.empty() ? 0.0 : statuses.back().explored_volume_m3(); };
  ASSERT_TRUE(frames_until([&] { return has_path() && volume_m3() > 0.0; })) << reason() << planner->log();
  const double known_m3 = volume_m3();
  planner->stop(SIGKILL);
  paths.clear();
  statuses.clear();
  candidates.clear();
  start_free();
  ASSERT_TRUE(frames_until([&] { return has_path() && !candidates.empty() && volume_m3() == known_m3; }))
      << volume_m3() << " of " << known_m3 << " m3, " << reason() << planner->log();
  EXPECT_EQ(state(), STATE_EXPLORING);
}

}  // namespace
}  // namespace lapis::test
