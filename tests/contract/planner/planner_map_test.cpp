// lapis_planner reads the map as the mapper says: by its sensor model, in its resolution, and not before it has said
// so.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/messages/labels.hpp"
#include "common/topics/slam.hpp"
#include "tests/contract/planner/planner_contract.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kMapper = "lapis_semantic_mapper";

double most_information(const lapis_msgs::msg::CandidateSet& set) {
  double most = 0.0;
  for (const auto& candidate : set.candidates()) most = std::max(most, candidate.mutual_information_nats());
  return most;
}

TEST(PlannerBesideAMapper, ReadsTheMapByTheMappersOwnModel) {
  TopicProbe probe;
  CameraFeed feed(probe);
  auto& slam = probe.advertise(topics::kTrackedFrame);
  ChildProcess mapper(kMapper, {"--set", "semantic_mapper.sensor_model.prior_occupied=0.1", "--set",
                                "semantic_mapper.resolution_m=0.2", "--set", "semantic_mapper.tile_period_s=0"});
  ChildProcess planner(kPlanner);
  ASSERT_TRUE(wait_until_ready(mapper) && wait_until_ready(planner)) << mapper.log() << planner.log();
  ASSERT_TRUE(probe.wait_until([&] { return feed.is_matched_by_mapper() && slam.matched() == 2; }));
  ASSERT_TRUE(probe.wait_until_known_by("semantic_mapper"));
  lapis_msgs::msg::TrackedFrame tracked;
  tracked.header().frame_id(SyntheticCamera::kOpticalFrame);
  tracked.map_frame_id("map");
  tracked.session(1);
  tracked.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING);
  tracked.keyframe_pose(messages::to_message(T_base_camera()));
  for (int i = 0; i < 3; ++i) {
    tracked.header().stamp(messages::to_message(CameraFeed::stamp(i)));
    tracked.pose_in_keyframe(messages::to_message(slow_motion(i)));
    feed.send(feed.frame(i));
    slam.publish(tracked);
  }
  const std::string classes = std::to_string(messages::from_message(feed.camera().label_info())->max_id());
  EXPECT_TRUE(
      planner.wait_for_line("map of 0.2 m voxels: fusion log_odds, prior_occupied 0.1, " + classes + " classes"))
      << planner.log() << mapper.log();
}

TEST_F(PlannerContract, TheSensorModelIsTheMappers) {
  std::map<double, double> information;
  for (const double prior : {0.1, 0.2}) {
    PlannerRun run;
    run.peers.description.sensor_model.prior_occupied = prior;
    ASSERT_TRUE(run.start()) << run.planner->log();
    run.peers.draw(kRoomWithDoor);
    ASSERT_TRUE(run.ticks_until([&] { return !run.candidates.empty(); })) << run.reason() << run.planner->log();
    information[prior] = most_information(run.candidates.front());
  }
  EXPECT_GT(information[0.1], 0.0);
  EXPECT_GT(std::abs(information[0.1] / information[0.2] - 1.0), 0.02) << "most of it is of unknown voxels";
  start_free();
}

TEST_F(PlannerContract, TilesWaitForTheDescriptionOfTheirMap) {
  ASSERT_TRUE(start()) << planner->log();
  peers.draw(kRoomWithDoor);  // the description comes with it
  ASSERT_TRUE(ticks_until([this] { return has_path(); })) << reason() << planner->log();
  const double volume_m3 = statuses.back().explored_volume_m3();
  peers.epoch = 6;
  peers.draws_without_description = true;
  peers.draw(Drawing(kRoomWithDoor.begin() + 8, kRoomWithDoor.end()));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(tick()) << planner->log();
  EXPECT_EQ(statuses.back().explored_volume_m3(), volume_m3) << "of a map that nobody has described";
  peers.describe_map();
  ASSERT_TRUE(ticks_until([&] { return statuses.back().explored_volume_m3() < 0.6 * volume_m3; })) << planner->log();
}

TEST_F(PlannerContract, DescriptionThatMakesNoSenseEndsIt) {
  get_going();
  peers.description.sensor_model.prior_occupied = std::nan("");
  peers.describe_map();
  EXPECT_EQ(planner->wait(), 1) << planner->log();
  has_ended = true;
  const char* reason = "/semantic_mapper/map_description: sensor_model.prior_occupied";
  EXPECT_THAT(planner->log(), HasSubstr(reason));
  EXPECT_TRUE(wait_until([this] { return !error().empty(); }, Seconds(5)));
  EXPECT_THAT(error(), HasSubstr(reason));
}

TEST_F(PlannerContract, MapThatIsNotAsItsDescriptionSaysEndsIt) {
  start_free();
  peers.draw(kRoomWithDoor);
  ASSERT_TRUE(frames_until([this] { return has_path(); })) << reason() << planner->log();
  auto message = messages::to_message(peers.description, peers.header());
  message.resolution_m(0.1);
  peers.map_description.publish(message);
  EXPECT_TRUE(frames_until([this] { return !planner->is_running(); })) << planner->log();
  EXPECT_EQ(planner->wait(), 1) << planner->log();
  has_ended = true;
  EXPECT_THAT(planner->log(), HasSubstr("resolution_m is 0.1"));
  EXPECT_THAT(planner->log(), HasSubstr("/semantic_mapper/map_state"));
}

TEST(PlannerSetUp, ItsOwnSensorModelIsGoneAndTheNewPlaceIsNamed) {
  ChildProcess planner(kPlanner, {"--set", "planner.sensor_model.prior_occupied=0.1"});
  EXPECT_EQ(planner.wait(), 2) << planner.log();
  EXPECT_THAT(planner.log(), HasSubstr("is now 'semantic_mapper.sensor_model.prior_occupied'"));
}

}  // namespace
}  // namespace lapis::test
