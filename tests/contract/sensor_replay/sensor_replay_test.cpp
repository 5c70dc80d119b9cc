// lapis_sensor_replay alone, with a data set that the test writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "common/messages/camera.hpp"
#include "common/messages/time.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/transforms.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/topic_probe.hpp"
#include "tests/unit/sensor_replay/synthetic_dataset.hpp"

namespace lapis::test {
namespace {

using sensor_replay::test::TemporaryFolder;
using sensor_replay::test::write_dataset;
using ::testing::HasSubstr;

constexpr const char* kReplay = "lapis_sensor_replay";
constexpr int kFrames = 12;

class ReplayContract : public ::testing::Test {
 protected:
  void SetUp() override { write_dataset(folder.path(), kFrames); }
  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {folder.path().string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  TemporaryFolder folder;
};

TEST_F(ReplayContract, EveryFrameComesWithItsStampAndFrameIds) {
  TopicProbe probe;
  const auto& color = probe.collect(topics::kColor);
  const auto& labels = probe.collect(topics::kLabels);
  const auto& info = probe.collect(topics::kColorInfo);
  const auto& truth = probe.collect(topics::kGroundTruth);
  const auto& clock = probe.collect(topics::kClock);
  const auto& mount = probe.collect(topics::kStaticTransforms);
  const auto& label_info = probe.collect(topics::kLabelInfo);
  const auto& depth = probe.collect(topics::kDepth);  // last: the replay waits for it, and then knows the others, too
  ChildProcess replay(kReplay, arguments({"--rate", "4", "--set", "sensor_replay.wait_for_readers=1"}));
  ASSERT_TRUE(probe.wait_until([&] { return depth.size() == kFrames && truth.size() == kFrames; })) << replay.log();
  ASSERT_TRUE(probe.wait_until([&] { return color.size() == kFrames && labels.size() == kFrames; })) << replay.log();
  ASSERT_TRUE(probe.wait_until([&] { return info.size() == kFrames && clock.size() == kFrames; })) << replay.log();
  ASSERT_TRUE(probe.wait_until([&] { return !mount.empty() && !label_info.empty(); })) << replay.log();
  EXPECT_EQ(replay.wait(), 0) << replay.log();
  ASSERT_EQ(info.size(), static_cast<std::size_t>(kFrames));
  for (std::size_t i = 0; i < color.size(); ++i) {
    const auto stamp = messages::from_message(color[i].header().stamp());
    EXPECT_EQ(messages::from_message(depth[i].header().stamp()), stamp);
    EXPECT_EQ(messages::from_message(labels[i].header().stamp()), stamp);
    EXPECT_EQ(messages::from_message(info[i].header().stamp()), stamp);
    EXPECT_EQ(messages::from_message(truth[i].header().stamp()), stamp);
    EXPECT_EQ(messages::from_message(clock[i].clock()), stamp);
    for (const auto& id : {color[i].header().frame_id(), depth[i].header().frame_id(), info[i].header().frame_id()}) {
      EXPECT_EQ(id, "camera_color_optical_frame");
    }
    EXPECT_EQ(truth[i].child_frame_id(), "base_link");
    const auto metres = messages::to_depth(depth[i]);
    ASSERT_TRUE(metres) << metres.reason;
    EXPECT_NEAR((*metres)(5, 3), 0.001 * sensor_replay::test::synthetic_depth(static_cast<int>(i), 5, 3), 1e-5);
    ASSERT_TRUE(messages::lens_camera(info[i]));
  }
  ASSERT_EQ(mount.size(), 1u);
  EXPECT_EQ(mount[0].transforms().back().child_frame_id(), "camera_color_optical_frame");
  EXPECT_EQ(label_info.size(), 1u);
}

TEST_F(ReplayContract, LateJoinerGetsMountAndLabelList) {
  ChildProcess replay(kReplay, arguments({"--rate", "1", "--set", "sensor_replay.wait_for_readers=1"}));
  ASSERT_TRUE(wait_until_ready(replay)) << replay.log();
  TopicProbe late;
  const auto& mount = late.collect(topics::kStaticTransforms);
  const auto& label_info = late.collect(topics::kLabelInfo);
  EXPECT_TRUE(late.wait_until([&] { return !mount.empty() && !label_info.empty(); })) << replay.log();
  EXPECT_EQ(replay.stop(SIGTERM), 0) << replay.log();
}

TEST_F(ReplayContract, LockstepWithoutParticipantsEndsWithTheirNames) {
  ChildProcess replay(kReplay, arguments({"--set", "lockstep.hard_timeout_s=1"}));
  EXPECT_EQ(replay.wait(), 1) << replay.log();
  EXPECT_THAT(replay.log(), HasSubstr("no answer of slam, semantic_mapper, evaluator"));
}

TEST_F(ReplayContract, DamagedFilesAreSkippedAndCounted) {
  std::vector<std::filesystem::path> depth_files;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path() / "depth")) depth_files.push_back(entry);
  std::sort(depth_files.begin(), depth_files.end());
  sensor_replay::test::truncate(depth_files.at(3), 0.5);
  std::filesystem::remove(depth_files.at(5));
  TopicProbe probe;
  const auto& color = probe.collect(topics::kColor);
  const auto& depth = probe.collect(topics::kDepth);
  ChildProcess replay(kReplay, arguments({"--rate", "4", "--set", "sensor_replay.wait_for_readers=1"}));
  ASSERT_TRUE(probe.wait_until([&] { return color.size() == kFrames && depth.size() == kFrames - 2; })) << replay.log();
  EXPECT_EQ(replay.wait(), 0) << replay.log();
  EXPECT_THAT(replay.log(), HasSubstr("depth images unusable"));
}

TEST_F(ReplayContract, ListNeedsNoDds) {
  ChildProcess replay(kReplay, arguments({"--list"}));
  EXPECT_EQ(replay.wait(), 0) << replay.log();
  EXPECT_THAT(replay.output(), HasSubstr(std::to_string(kFrames)));
}

TEST_F(ReplayContract, EndsCleanlyInTheMiddle) {
  for (const int signal : {SIGTERM, SIGINT}) {
    ChildProcess replay(kReplay, arguments({"--rate", "0.1"}));
    ASSERT_TRUE(wait_until_ready(replay)) << replay.log();
    EXPECT_EQ(replay.stop(signal, Seconds(5)), 0) << replay.log();
  }
}

TEST(ReplaySetUp, MissingDataSetIsStatus2AndNamed) {
  ChildProcess missing(kReplay, {"/no/such/dataset"});
  EXPECT_EQ(missing.wait(), 2) << missing.log();
  EXPECT_THAT(missing.log(), HasSubstr("/no/such/dataset"));
  ChildProcess none(kReplay);
  EXPECT_EQ(none.wait(), 2) << none.log();
  TemporaryFolder empty;
  ChildProcess nothing(kReplay, {empty.path().string()});
  EXPECT_EQ(nothing.wait(), 2) << nothing.log();
}

}  // namespace
}  // namespace lapis::test
