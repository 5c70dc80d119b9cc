// lapis_planner alone: it chooses frontiers, says why, obeys, and ends.
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "common/topics/planner.hpp"
#include "common/topics/planner_views.hpp"
#include "common/topics/services.hpp"
#include "tests/contract/planner/planner_contract.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;
using namespace lapis_msgs::msg::PlannerStatus_Constants;

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(PlannerContract, DrivesToTheFrontierInTheDoor) {
  get_going();
  EXPECT_EQ(state(), STATE_EXPLORING);
  EXPECT_THAT(reason(),
              testing::MatchesRegex("drives to frontier ([0-9]+) \\(frontier [0-9]+: [0-9]+ nats, loops with [0-9.]+ "
                                    "old places for [0-9.]+ m, [0-9.e+]+; .*\\)"));
  EXPECT_GT(statuses.back().explored_volume_m3(), 20.0);
  EXPECT_EQ(paths.back().header().stamp(), messages::to_message(peers.stamp));
  const auto& first = paths.back().poses().front().pose().position();
  EXPECT_LT((Eigen::Vector2d(first.x(), first.y()) - peers.position).norm(), 0.15);
  EXPECT_LT((goal() - Eigen::Vector2d(5.0, 1.9)).norm(), 2.1) << "from where the door is looked at";
  EXPECT_TRUE(goal().x() > 0.4 && goal().x() < 5.0 && goal().y() > 0.4 && goal().y() < 3.6) << "in the room";
}

TEST_F(PlannerContract, SaysWhatEveryCandidateIsWorthOrWhyItIsRejected) {
  ASSERT_TRUE(start()) << planner->log();
  Drawing lines = kRoomWithDoor;
  for (std::string& line : lines) line.resize(40, ' ');
  for (std::size_t i = 4; i < 12; ++i) lines[i].replace(30, 8, "........");  // seen, but there is no path
  peers.pose_graph.publish(peers.graph());
  peers.draw(lines);
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  ASSERT_EQ(candidates.size(), 1U);
  EXPECT_EQ(candidates[0].header().frame_id(), "map");
  EXPECT_EQ(candidates[0].method(), "lapis");
  int selected = 0, unreachable = 0;
  for (const auto& candidate : candidates[0].candidates()) {
    EXPECT_EQ(candidate.is_rejected(), !candidate.reason().empty());
    EXPECT_TRUE(messages::from_message(candidate.goal()));
    unreachable += candidate.reason() == "cannot be reached" ? 1 : 0;
    if (candidate.is_rejected()) continue;
    selected += candidate.is_selected() ? 1 : 0;
    EXPECT_GT(candidate.cost_m(), 0.0);
    EXPECT_GT(candidate.mutual_information_nats(), 0.0);
    EXPECT_GT(candidate.d_optimality(), 0.0);
    EXPECT_GT(candidate.utility(), 0.0);
    EXPECT_TRUE(std::isfinite(candidate.mutual_information_nats()) && std::isfinite(candidate.d_optimality()) &&
                std::isfinite(candidate.utility()) && std::isfinite(candidate.cost_m()));
  }
  EXPECT_EQ(selected, 1);
  EXPECT_GT(unreachable, 0);
}

TEST_F(PlannerContract, InformationFromWhereSlamIsUnsureCountsLess) {
  const auto most_information = [this] {
    double most = 0.0;
    for (const auto& candidate : candidates.back().candidates())
      most = std::max(most, candidate.mutual_information_nats());
    return most;
  };
  ASSERT_TRUE(start({"information_discount_sigma_m=0.3"})) << planner->log();
  peers.pose_graph.publish(peers.graph());
  peers.draw(kRoomWithDoor);
  ASSERT_TRUE(ticks_until([this] { return !candidates.empty(); })) << reason() << planner->log();
  const double sure = most_information();
  peers.position_sigma_m = 0.3;
  ASSERT_TRUE(tick());
  peers.pose_graph.publish(peers.graph());
  const std::size_t so_far = candidates.size();
  ASSERT_TRUE(ticks_until([&] { return candidates.size() > so_far + 1; })) << reason() << planner->log();
  EXPECT_GT(most_information(), 0.0);
  EXPECT_LT(most_information(), 0.51 * sure);
}

TEST_F(PlannerContract, LateJoinerGetsPathCandidatesAndStatus) {
  get_going();
  TopicProbe late("late");
  const auto& path = late.collect(topics::kPlannerPath);
  const auto& set = late.collect(topics::kCandidates);
  const auto& status = late.collect(topics::kPlannerStatus);
  ASSERT_TRUE(late.wait_until([&] { return !path.empty() && !set.empty() && !status.empty(); })) << planner->log();
  EXPECT_EQ(path.back(), paths.back());
  EXPECT_EQ(set.back(), candidates.back());
  EXPECT_EQ(status.back(), statuses.back());
}

TEST_F(PlannerContract, MarkersAreMadeForReadersOnly) {
  get_going();
  TopicProbe viewer("viewer");
  const auto& markers = viewer.collect(topics::kPlannerMarkers);
  ASSERT_TRUE(viewer.wait_until_known_by("planner"));
  const time::Time joined = peers.stamp;
  ASSERT_TRUE(tick()) << planner->log();
  ASSERT_TRUE(viewer.wait_until([&] { return !markers.empty(); })) << "at once for a new reader" << planner->log();
  ASSERT_GE(markers[0].markers().size(), 3U);
  EXPECT_GT(messages::from_message(markers[0].markers()[0].header().stamp()), joined) << "there were some before";
  const std::size_t decisions = candidates.size();
  ASSERT_TRUE(ticks_until([&] { return candidates.size() > decisions; }));
  EXPECT_TRUE(viewer.wait_until([&] { return markers.size() == 2; })) << "and with each decision" << planner->log();
}

class PlannerLatency : public PlannerContract, public ::testing::WithParamInterface<int> {};

TEST_P(PlannerLatency, DecisionTakesEffectSoManyFramesLater) {
  ASSERT_TRUE(start({"decision_latency_frames=" + std::to_string(GetParam())})) << planner->log();
  peers.draw(kRoomWithDoor);
  EXPECT_EQ(ticks_until([this] { return has_path(); }), 1 + GetParam()) << planner->log();
}

INSTANTIATE_TEST_SUITE_P(Frames, PlannerLatency, ::testing::Values(1, 3, 10),
                         [](const auto& frames) { return "after" + std::to_string(frames.param); });

TEST_F(PlannerContract, WaitsForMapAndPose) {
  ASSERT_TRUE(start()) << planner->log();
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << planner->log();
  EXPECT_EQ(state(), STATE_EXPLORING);
  EXPECT_THAT(reason(), HasSubstr("waits for"));
  ASSERT_EQ(paths.size(), 1U) << "a controller may still follow the path of a planner that has died";
  EXPECT_TRUE(paths.front().poses().empty());
}

TEST_F(PlannerContract, ClosedRoomIsDone) {
  peers.drives = true;
  ASSERT_TRUE(start()) << planner->log();
  peers.draw(kClosedRoom);
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_DONE; }, 20.0)) << reason() << planner->log();
  EXPECT_EQ(reason(), "nothing is left that can be reached");
  EXPECT_FALSE(has_path());
}

TEST_F(PlannerContract, DoorThatCloses) {
  get_going();
  peers.draw(kClosedRoom);
  ASSERT_TRUE(ticks_until([this] { return stands(); })) << reason() << planner->log();
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_DONE; }, 30.0)) << reason() << planner->log();
}

TEST_F(PlannerContract, GoesHomeAtTheEndWhenAskedTo) {
  peers.drives = true;
  ASSERT_TRUE(start({"returns_home=true"})) << planner->log();
  peers.draw(kRoomWithDoor);
  ASSERT_TRUE(ticks_until([this] { return (peers.position - Eigen::Vector2d(2, 2)).norm() > 1.0; })) << reason();
  peers.draw(kClosedRoom);
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_DONE; }, 30.0)) << reason() << planner->log();
  EXPECT_THAT(reason(), testing::StartsWith("is back where it started; nothing is left that can be reached"));
  EXPECT_LT((peers.position - Eigen::Vector2d(2, 2)).norm(), 0.31);
}

TEST_F(PlannerContract, ConsolidatesWhenNothingIsLeft) {
  peers.drives = true;
  ASSERT_TRUE(start({"then=nearest"})) << planner->log();
  peers.draw(kClosedRoom);
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_CONSOLIDATING; }, 20.0)) << reason() << planner->log();
  EXPECT_THAT(reason(), HasSubstr("nothing is left that can be reached"));
}

// Services -----------------------------------------------------------------------------------------------------------

class PlannerServices : public PlannerContract {
 protected:
  using Client = dds::ServiceClient<std_srvs::srv::Trigger>;

  PlannerServices() {
    for (Client* client : {&start_, &stop_, &pause_, &home_}) context.executor().add(*client);
  }
  /// Calls and waits for the answer.
  std::string call(Client& client) {
    std::optional<std_srvs::srv::Trigger_Response> reply;
    if (!wait_until([&] { return client.is_ready(); })) return "no server";
    const auto number = client.call({});
    if (!wait_until([&] { return (reply = client.take_reply(*number)).has_value(); })) return "no reply";
    return reply->success() ? reply->message() : "refused";
  }
  Client start_{context.participant(), topics::kStartExploring};
  Client stop_{context.participant(), topics::kStopExploring};
  Client pause_{context.participant(), topics::kPauseExploring};
  Client home_{context.participant(), topics::kReturnHome};
};

TEST_F(PlannerServices, WithoutAutostartItWaitsForStart) {
  ASSERT_TRUE(start({"autostart=false"})) << planner->log();
  peers.draw(kRoomWithDoor);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(tick()) << planner->log();
  EXPECT_EQ(state(), STATE_IDLE);
  EXPECT_FALSE(has_path());
  EXPECT_EQ(call(start_), "exploring");
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  EXPECT_EQ(state(), STATE_EXPLORING);
}

TEST_F(PlannerServices, PauseAndStopMakeItStandStillUntilStart) {
  get_going();
  for (Client* client : {&pause_, &stop_}) {
    EXPECT_EQ(call(*client), client == &pause_ ? "paused" : "stopped");
    ASSERT_TRUE(tick()) << planner->log();
    EXPECT_TRUE(stands()) << "with the next tick";
    EXPECT_EQ(state(), client == &pause_ ? STATE_PAUSED : STATE_IDLE);
    const std::size_t before = paths.size();
    for (int i = 0; i < 30; ++i) ASSERT_TRUE(tick()) << planner->log();
    EXPECT_EQ(paths.size(), before) << "a decision under way changes nothing any more";
    EXPECT_EQ(call(start_), "exploring");
    ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  }
}

TEST_F(PlannerServices, ReturnsHomeAndIsDone) {
  peers.drives = true;
  get_going();
  ASSERT_TRUE(ticks_until([this] { return (peers.position - Eigen::Vector2d(2, 2)).norm() > 1.0; })) << reason();
  EXPECT_EQ(call(home_), "returning");
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_RETURNING && has_path(); })) << reason();
  EXPECT_LT((goal() - Eigen::Vector2d(2, 2)).norm(), 0.3);
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_DONE; }, 20.0)) << reason() << planner->log();
  EXPECT_EQ(reason(), "is back where it started");
  EXPECT_TRUE(stands());
}

TEST_F(PlannerServices, DrivesToAGoalAndPausesThere) {
  auto& goals = context.advertise(topics::kGoal);
  peers.drives = true;
  get_going();
  geometry_msgs::msg::PoseStamped there;
  there.header().frame_id("elsewhere");
  there.pose().position().x(3.0);
  there.pose().position().y(2.5);
  ASSERT_TRUE(wait_until([&] { return goals.matched() > 0; }));
  goals.publish(there);
  ASSERT_TRUE(planner->wait_for_line("goal dropped: it is not in map")) << planner->log();
  there.header().frame_id("map");
  goals.publish(there);
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_RETURNING && has_path(); })) << reason();
  EXPECT_LT((goal() - Eigen::Vector2d(3.0, 2.5)).norm(), 0.3);
  ASSERT_TRUE(ticks_until([this] { return state() == STATE_PAUSED; }, 20.0)) << reason() << planner->log();
  EXPECT_EQ(reason(), "is at the place that was asked for");
  EXPECT_TRUE(stands());
}

// Files and ends -----------------------------------------------------------------------------------------------------

TEST_F(PlannerContract, LastWordAfterSigtermIsAnEmptyPath) {
  get_going();
  const std::size_t before = paths.size();
  has_ended = true;
  planner->signal(SIGTERM);
  EXPECT_TRUE(wait_until([&] { return paths.size() > before; })) << planner->log();
  EXPECT_TRUE(stands());
  EXPECT_EQ(planner->wait(), 0) << planner->log();
}

TEST(PlannerSetUp, OutputFolderThatCannotBeWrittenIsNamedWithItsKey) {
  ChildProcess planner(kPlanner, {"--set", "planner.output_dir=/proc/none"});
  EXPECT_EQ(planner.wait(), 2) << planner.log();
  EXPECT_THAT(planner.log(), HasSubstr("planner.output_dir"));
  EXPECT_THAT(planner.log(), HasSubstr("/proc/none"));
}

TEST(PlannerSetUp, KeysThatContradictEachOtherAreNamed) {
  const std::vector<std::pair<std::string, std::string>> contradictions{
      {"planner.viewpoints.min_distance_m=2.5", "planner.viewpoints.max_distance_m"},
      {"planner.hallucination.impossible_landmarks=100", "planner.hallucination.certain_landmarks"},
      {"robot.obstacle_min_height_m=2", "robot.obstacle_max_height_m"},
      {"planner.viewpoints.max_distance_m=6", "robot.sensing_range_m"},
      {"planner.slowest_m_s=0.6", "robot.max_speed_m_s"},
      {"robot.radius_m=0.45", "planner.path.comfort_m"},
      {"planner.path.comfort_m=2", "planner.grid.max_clearance_m"}};
  for (const auto& [setting, key] : contradictions) {
    ChildProcess planner(kPlanner, {"--set", setting});
    EXPECT_EQ(planner.wait(), 2) << setting << planner.log();
    EXPECT_THAT(planner.log(), HasSubstr(key)) << setting;
  }
}

/// Drives around with a door that opens and one that closes; what it wrote, and all paths from the first that leads
/// somewhere.
struct Story {
  Story() {
    PlannerRun run;
    run.peers.drives = true;
    is_complete = run.start({"output_dir=" + folder.path().string(), "method=joint"});
    run.peers.draw(kRoomWithDoor);
    for (int i = 0; i < 120 && is_complete; ++i) {
      if (i == 40) run.peers.draw(kRoomWithTwoDoors);
      if (i % 30 == 10) run.peers.pose_graph.publish(run.peers.graph());
      is_complete = run.tick();
    }
    is_complete = is_complete && run.planner->stop(SIGTERM) == 0;
    log = run.planner->log();
    // Without the empty path of its start: the next one replaces it unless the reader was matched before.
    const auto leads = [](const nav_msgs::msg::Path& path) { return !path.poses().empty(); };
    paths.assign(std::find_if(run.paths.begin(), run.paths.end(), leads), run.paths.end());
    csv = read(folder.path() / "decisions.csv");
  }

  TemporaryFolder folder;
  bool is_complete = false;
  std::string log, csv;
  std::vector<nav_msgs::msg::Path> paths;
};

TEST(PlannerFiles, SameInputGivesTheSamePathsAndTheSameDecisionsFile) {
  const Story first;
  ASSERT_TRUE(first.is_complete) << first.log;
  EXPECT_GT(std::count(first.csv.begin(), first.csv.end(), '\n'), 20) << "rows";
  EXPECT_THAT(first.csv, HasSubstr("decision,time_s,method,"));
  EXPECT_THAT(first.csv, HasSubstr(",joint,"));
  EXPECT_GT(first.paths.size(), 3U);
  const Story second;
  ASSERT_TRUE(second.is_complete) << second.log;
  EXPECT_EQ(second.csv, first.csv);
  EXPECT_TRUE(second.paths == first.paths);
}

}  // namespace
}  // namespace lapis::test
