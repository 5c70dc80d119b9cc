// lapis_evaluator alone, as a process in a run: slam, truth and camera are played by the test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "common/mapping/file/map_file.hpp"
#include "common/messages/geometry.hpp"
#include "common/messages/labels.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/slam.hpp"
#include "tests/support/camera_feed.hpp"
#include "tests/support/child_process.hpp"

namespace lapis::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kEvaluator = "lapis_evaluator";

std::string fresh_folder() {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "lapis_evaluator_contract";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder.string();
}

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Number with that key in metrics.json; NaN for null.
double number_of(const std::string& metrics, const std::string& key) {
  const std::string quoted = "\"" + key + "\": ";
  const auto at = metrics.find(quoted);
  const std::string value = at == std::string::npos ? "null" : metrics.substr(at + quoted.size(), 32);
  return value.starts_with("null") ? std::numeric_limits<double>::quiet_NaN() : std::stod(value);
}

class EvaluatorContract : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(wait_until_ready(evaluator)) << evaluator.log();
    ASSERT_TRUE(probe.wait_until([&] {
      return truth.matched() > 0 && slam.matched() > 0 && contact.matched() > 0 && map.matched() > 0 &&
             feed.is_matched_by_evaluator();
    })) << evaluator.log();
  }
  nav_msgs::msg::Odometry true_pose(int index) const {
    nav_msgs::msg::Odometry message;
    message.header().stamp(messages::to_message(CameraFeed::stamp(index) + clock));
    message.header().frame_id("world");
    message.child_frame_id("base_link");
    message.pose().pose(messages::to_message(T_base_camera() * slow_motion(index) * T_base_camera().inverse()));
    return message;
  }
  lapis_msgs::msg::TrackedFrame tracked(int index) const {
    lapis_msgs::msg::TrackedFrame message;
    message.header().stamp(messages::to_message(CameraFeed::stamp(index) + clock));
    message.header().frame_id(SyntheticCamera::kOpticalFrame);
    message.map_frame_id("map");
    message.session(1);
    message.state(lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING);
    message.source(lapis_msgs::msg::TrackedFrame_Constants::SOURCE_VISION);
    message.keyframe_pose(messages::to_message(T_base_camera()));
    message.pose_in_keyframe(messages::to_message(slow_motion(index)));
    return message;
  }
  void send(const CameraFrame& frame, int index) {
    truth.publish(true_pose(index));
    feed.send(frame);
    slam.publish(tracked(index));
  }

  /// As the mapper does; `resolution_m` of its map.
  void describe_map(double resolution_m = 0.25) {
    mapping::MapDescription description;
    description.resolution_m = resolution_m;
    description.sensor_model.prior_occupied = 0.1;
    description.labels = *messages::from_message(feed.camera().label_info());
    description.sensor_model = mapping::with_classes(description.sensor_model, description.labels);
    map.publish(messages::to_message(description, {}));
    map.wait_until_acknowledged(5.0);
  }
  mapping::MapFile reference_map() const {
    std::string error;
    auto file = mapping::load_map(folder + "/reference_map.lapis", error);
    if (!file) throw std::runtime_error(error);
    return std::move(*file);
  }

  /// Waits until the evaluator has recorded so many frames.
  bool has_recorded(int frames) {
    return probe.wait_until(
        [&] { return newest_values(diagnostics, "evaluator")["frames"] == std::to_string(frames); });
  }

  const std::string folder = fresh_folder();
  time::Duration clock;  ///< by which the clock of all stamps was set
  TopicProbe probe;
  CameraFeed feed{probe};
  dds::Publisher<nav_msgs::msg::Odometry>& truth = probe.advertise(topics::kGroundTruth);
  dds::Publisher<lapis_msgs::msg::TrackedFrame>& slam = probe.advertise(topics::kTrackedFrame);
  dds::Publisher<lapis_msgs::msg::MapDescription>& map = probe.advertise(topics::kMapDescription);
  dds::Publisher<std_msgs::msg::Bool>& contact = probe.advertise(topics::kCollision);
  const std::vector<diagnostic_msgs::msg::DiagnosticArray>& diagnostics = probe.collect(topics::kDiagnostics);
  ChildProcess evaluator{kEvaluator, {"--set", "evaluator.output_dir=" + folder, "--set", "evaluator.figures=false"}};
};

TEST_F(EvaluatorContract, WritesTheRunFolderWhenItIsStopped) {
  constexpr int kFrames = 4;  // no more at once than a reader keeps (5)
  for (int i = 0; i < kFrames; ++i) send(feed.frame(i), i);
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["frames"] == "4"; }))
      << evaluator.log();
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  const std::string metrics = read(std::filesystem::path(folder) / "metrics.json");
  EXPECT_THAT(metrics, HasSubstr("\"frames_total\": 4"));
  EXPECT_THAT(metrics, HasSubstr("\"frames_tracked\": 4"));
  EXPECT_THAT(metrics, Not(HasSubstr("nan")));
  EXPECT_THAT(metrics, HasSubstr("\"collisions\": null"));  // nobody published contacts
  for (const char* file : {"trajectory_estimate.txt", "trajectory_ground_truth.txt", "timeline.csv"}) {
    EXPECT_FALSE(read(std::filesystem::path(folder) / file).empty()) << file;
  }
}

/// Number of hits for a class and for none in the reference map.
std::pair<std::uint64_t, std::uint64_t> hits_of(const mapping::MapFile& file) {
  std::pair<std::uint64_t, std::uint64_t> labelled_and_not{};
  file.map.for_each_observed([&](const auto&, const mapping::VoxelCounts& counts) {
    for (const auto& hit : counts.hits)
      (hit.label != 0 ? labelled_and_not.first : labelled_and_not.second) += hit.count;
  });
  return labelled_and_not;
}

// A slow network: the labels of a frame come more than a second after it, at 30 Hz.
TEST_F(EvaluatorContract, LabelsThatComeLateAreInTheReferenceAndNoFrameIsLost) {
  constexpr int kFrames = 45, kLate = 36, kLost = 40;  // the last labels never come
  describe_map();
  std::vector<sensor_msgs::msg::Image> late;
  for (int i = 0; i < kFrames; ++i) {
    CameraFrame frame = feed.frame(i);
    late.push_back(*frame.labels);
    frame.labels.reset();
    send(frame, i);
    feed.send({.color = {}, .depth = frame.depth, .labels = {}, .info = {}});  // when it is refused, all have come
    ASSERT_TRUE(probe.wait_until([&] {
      return sum_of(newest_values(diagnostics, "evaluator"), "depth dropped: stamp was there before") == i + 1;
    })) << i
        << evaluator.log();
    if (i < kLate) continue;
    const auto of_then = static_cast<std::size_t>(i - kLate);
    feed.send({.color = {}, .depth = {}, .labels = late[of_then], .info = {}});
    ASSERT_TRUE(has_recorded(i - kLate + 1)) << i << evaluator.log();
  }
  for (int i = kFrames - kLate; i < kLost; ++i) {
    feed.send({.color = {}, .depth = {}, .labels = late[static_cast<std::size_t>(i)], .info = {}});
    ASSERT_TRUE(has_recorded(i + 1)) << i << evaluator.log();
  }
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  EXPECT_THAT(read(std::filesystem::path(folder) / "metrics.json"),
              HasSubstr("\"frames_total\": " + std::to_string(kFrames)));
  const auto [labelled, unlabelled] = hits_of(reference_map());
  EXPECT_GT(unlabelled, 0U) << "frames without labels are in the reference, too";
  EXPECT_NEAR(static_cast<double>(unlabelled) / static_cast<double>(labelled + unlabelled),
              static_cast<double>(kFrames - kLost) / kFrames, 0.02);
}

TEST_F(EvaluatorContract, TheReferenceIsBuiltAsTheMapIs) {
  describe_map(0.2);
  for (int i = 0; i < 4; ++i) send(feed.frame(i), i);
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["frames"] == "4"; }))
      << evaluator.log();
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  const mapping::MapFile reference = reference_map();
  EXPECT_EQ(reference.map.resolution_m(), 0.2);
  EXPECT_GT(reference.map.block_count(), 0U);
  EXPECT_EQ(reference.sensor_model.prior_occupied, 0.1);
  EXPECT_EQ(reference.labels, *messages::from_message(feed.camera().label_info()));
  EXPECT_EQ(reference.frames, mapping::FrameSettings{});
}

TEST_F(EvaluatorContract, WithoutAMapperThereIsNoReference) {
  send(feed.frame(0), 0);
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["frames"] == "1"; }))
      << evaluator.log();
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  EXPECT_THAT(evaluator.log(), HasSubstr("no mapper has said how its map is built"));
  EXPECT_FALSE(std::filesystem::exists(folder + "/reference_map.lapis"));
}

TEST_F(EvaluatorContract, AnotherMapInTheMiddleOfTheRunEndsIt) {
  describe_map();
  send(feed.frame(0), 0);
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["frames"] == "1"; }))
      << evaluator.log();
  describe_map(0.1);
  EXPECT_EQ(evaluator.wait(Seconds(20)), 1) << evaluator.log();
  EXPECT_THAT(evaluator.log(), HasSubstr("another one than before in this run: resolution_m 0.25 and 0.1"));
  EXPECT_EQ(reference_map().map.resolution_m(), 0.25) << "what was judged so far is kept";
}

TEST_F(EvaluatorContract, DescriptionThatMakesNoSenseEndsIt) {
  map.publish({});
  EXPECT_EQ(evaluator.wait(Seconds(20)), 1) << evaluator.log();
  EXPECT_THAT(evaluator.log(), HasSubstr("/semantic_mapper/map_description: "));
}

TEST_F(EvaluatorContract, ACollisionIsTheBeginningOfAContact) {
  for (const bool is_in_contact : {false, true, true, false, true}) {
    std_msgs::msg::Bool message;
    message.data(is_in_contact);
    contact.publish(message);
  }
  send(feed.frame(0), 0);
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["collisions"] == "2"; }))
      << evaluator.log();
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  EXPECT_THAT(read(std::filesystem::path(folder) / "metrics.json"), HasSubstr("\"collisions\": 2"));
}

TEST_F(EvaluatorContract, ThePlannersDecisionsAndSlamsSigmaAreKept) {
  auto& planner = probe.advertise(topics::kPlannerStatus);
  auto& pose = probe.advertise(topics::kSlamOdometry);
  ASSERT_TRUE(probe.wait_until([&] { return planner.matched() > 0 && pose.matched() > 0; })) << evaluator.log();
  nav_msgs::msg::Odometry odometry;
  odometry.header().stamp(messages::to_message(CameraFeed::stamp(0)));
  for (const std::size_t diagonal : {0U, 7U, 14U}) odometry.pose().covariance()[diagonal] = 0.0012;
  pose.publish(odometry);
  lapis_msgs::msg::PlannerStatus status;
  status.state(lapis_msgs::msg::PlannerStatus_Constants::STATE_EXPLORING);
  status.reason("drives somewhere");
  status.decision_time_s(0.25);
  status.decisions(2);
  status.failures(3);
  planner.publish(status);
  planner.wait_until_acknowledged(5.0);
  pose.wait_until_acknowledged(5.0);
  send(feed.frame(0), 0);
  ASSERT_TRUE(evaluator.wait_for_line("progress: 0 s, 0 m3 explored, 0.0 m driven, loops closed: 0, EXPLORING: drives"))
      << evaluator.log();
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  const std::string metrics = read(std::filesystem::path(folder) / "metrics.json");
  EXPECT_THAT(metrics, HasSubstr("\"planner_state\": \"EXPLORING\""));
  EXPECT_THAT(metrics, HasSubstr("\"decisions\": 2"));
  EXPECT_THAT(metrics, HasSubstr("\"failures\": 3"));
  EXPECT_THAT(metrics, HasSubstr("\"planner_reason\": \"drives somewhere\""));
  EXPECT_THAT(metrics, HasSubstr("\"decision_time_p95_s\": 0.25"));
  EXPECT_THAT(read(std::filesystem::path(folder) / "timeline.csv"), HasSubstr(",0.060000,TRACKING,EXPLORING,0\n"));
}

TEST_F(EvaluatorContract, WhatHoldsThePoseIsKeptByFrameWithItsSigmaAndWhateverItIsItIsJudged) {
  auto& pose = probe.advertise(topics::kSlamOdometry);
  ASSERT_TRUE(probe.wait_until([&] { return pose.matched() > 0; })) << evaluator.log();
  using namespace lapis_msgs::msg::TrackedFrame_Constants;
  const std::array sources = {SOURCE_VISION, SOURCE_ODOMETRY, SOURCE_NONE, SOURCE_SURFACES};
  for (int i = 0; i < static_cast<int>(sources.size()); ++i) {
    auto message = tracked(i);
    message.source(sources[static_cast<std::size_t>(i)]);
    truth.publish(true_pose(i));
    feed.send(feed.frame(i));
    slam.publish(message);
    if (message.source() == SOURCE_NONE) continue;
    nav_msgs::msg::Odometry odometry;  // after the frame that waits for it
    odometry.header().stamp(message.header().stamp());
    odometry.pose().covariance()[0] = (i + 1) * (i + 1) * 0.0001;
    pose.publish(odometry);
  }
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["frames"] == "4"; }))
      << evaluator.log();
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  const std::string frames = read(std::filesystem::path(folder) / "frames.csv");
  EXPECT_THAT(frames, ::testing::MatchesRegex("time_s,tier,path_length_m,position_sigma_m,position_error_m\n"
                                              "[0-9.]+,vision,[0-9.]+,0.010000,0.000000\n"
                                              "[0-9.]+,odometry,[0-9.]+,0.020000,0.000000\n"
                                              "[0-9.]+,none,[0-9.]+,,\n"
                                              "[0-9.]+,surfaces,[0-9.]+,0.040000,0.000000\n"));
  const std::string metrics = read(std::filesystem::path(folder) / "metrics.json");
  EXPECT_THAT(metrics, HasSubstr("\"frames_tracked\": 2"));
  for (const char* share : {"tier_surfaces_share", "tier_odometry_share", "lost_share"}) {
    EXPECT_THAT(metrics, HasSubstr("\"" + std::string(share) + "\": 0.333")) << "frames are evenly spaced";
  }
}

// The key-frames of the pose graph have the time of slam's map.
TEST_F(EvaluatorContract, AClockThatIsSetMakesNoFigureWrong) {
  auto& graphs = probe.advertise(topics::kPoseGraph);
  ASSERT_TRUE(probe.wait_until([&] { return graphs.matched() > 0; })) << evaluator.log();
  int index = 0;
  lapis_msgs::msg::PoseGraph graph;
  graph.session(1);
  const auto send_next = [&] {
    auto message = tracked(index);
    if (index % 2 == 0) {  // a new key-frame
      message.is_keyframe(true);
      message.keyframe_id(graph.nodes().size());
      lapis_msgs::msg::PoseGraphNode node;
      node.id(message.keyframe_id());
      node.stamp(messages::to_message(CameraFeed::stamp(index)));
      node.pose(messages::to_message(T_base_camera() * slow_motion(index)));
      graph.nodes().push_back(node);
      message.keyframe_pose(node.pose());
      message.pose_in_keyframe(messages::to_message(geometry::Pose::Identity()));
    }
    truth.publish(true_pose(index));
    feed.send(feed.frame(CameraFeed::stamp(index) + clock, slow_motion(index)));
    slam.publish(message);
    ++index;
  };
  for (const std::int64_t set_to_ns : {0LL, 3'600'000'000'000LL, 3'595'000'000'000LL, 0LL}) {
    clock = {set_to_ns};
    for (int i = 0; i < 3; ++i) send_next();
    ASSERT_TRUE(has_recorded(index)) << index << evaluator.log();
  }
  graphs.publish(graph);
  graphs.wait_until_acknowledged(5.0);
  send_next();
  ASSERT_TRUE(has_recorded(index)) << evaluator.log();
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  const std::string metrics = read(std::filesystem::path(folder) / "metrics.json");
  EXPECT_THAT(metrics, HasSubstr("\"frames_total\": 13"));
  EXPECT_THAT(metrics, HasSubstr("\"frames_tracked\": 13"));
  EXPECT_LT(number_of(metrics, "duration_s"), 100.0) << "the time that the test took";
  EXPECT_LT(number_of(metrics, "ate_raw_rmse_m"), 1e-6);
  EXPECT_LT(number_of(metrics, "keyframe_ate_raw_rmse_m"), 1e-6);
  EXPECT_LT(number_of(metrics, "correction_rmse_m"), 1e-6);
  EXPECT_LT(number_of(metrics, "lost_time_s"), 1.0) << "known to the jitter of arrivals";
  const std::string frames = read(std::filesystem::path(folder) / "frames.csv");
  EXPECT_EQ(std::count(frames.begin(), frames.end(), '\n'), 1 + 13) << frames;
}

TEST_F(EvaluatorContract, GarbageIsSurvived) {
  describe_map();
  send(feed.frame(0), 0);
  auto wrong = feed.frame(1);
  wrong.depth->encoding("rgb8");
  wrong.labels->data().resize(3);
  send(wrong, 1);
  auto info = feed.frame(2);
  info.info->width(3);
  send(info, 2);
  send(feed.frame(2), 2);  // duplicate
  send(feed.frame(1), 1);  // backward
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["frames"] == "3"; }))
      << evaluator.log();
  auto bad_pose = tracked(3);
  bad_pose.keyframe_pose().orientation().w(5.0);
  slam.publish(bad_pose);
  truth.publish(true_pose(3));
  feed.send(feed.frame(3));
  send(feed.frame(4), 4);
  ASSERT_TRUE(probe.wait_until([&] { return newest_values(diagnostics, "evaluator")["frames"] == "5"; }))
      << evaluator.log();
  const auto values = newest_values(diagnostics, "evaluator");
  EXPECT_GE(sum_of(values, "not in the reference"), 2);
  EXPECT_GE(sum_of(values, "without a valid pose"), 1);
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(20)), 0) << evaluator.log();
  EXPECT_THAT(read(std::filesystem::path(folder) / "metrics.json"), HasSubstr("\"frames_tracked\": 4"));
}

TEST_F(EvaluatorContract, SilenceWritesNothingAndIsNoFailure) {
  EXPECT_EQ(evaluator.stop(SIGTERM, Seconds(10)), 0) << evaluator.log();
  EXPECT_THAT(evaluator.log(), HasSubstr("came; nothing is written"));
  EXPECT_FALSE(std::filesystem::exists(std::filesystem::path(folder) / "metrics.json"));
}

TEST(EvaluatorSetUp, TheMapsSettingsAreTheMappers) {
  ChildProcess evaluator(kEvaluator, {"--set", "evaluator.integration.min_range_m=0.3"});
  EXPECT_EQ(evaluator.wait(), 2) << evaluator.log();
  EXPECT_THAT(evaluator.log(), HasSubstr("is now 'semantic_mapper.integration.min_range_m'"));
}

TEST(EvaluatorSetUp, FolderIsRequired) {
  ChildProcess evaluator(kEvaluator);
  EXPECT_EQ(evaluator.wait(), 2) << evaluator.log();
  EXPECT_THAT(evaluator.log(), HasSubstr("evaluator.output_dir"));
  ChildProcess nowhere(kEvaluator, {"--set", "evaluator.output_dir=/proc/nowhere"});
  EXPECT_EQ(nowhere.wait(), 2) << nowhere.log();
}

}  // namespace
}  // namespace lapis::test
