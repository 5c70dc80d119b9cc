#include "common/topics.hpp"

#include <gtest/gtest.h>

#include <string>

namespace lapis {
namespace {

// Laws of one row of the topic table.
template <class Message>
void expect_sound(const dds::Topic<Message>& topic) {
  const std::string name = topic.name;
  const bool is_ros = name.front() == '/';
  EXPECT_EQ(is_ros, !topic.qos.keyed) << name << ": ROS 2 has no keys, so keyed topics are plain DDS names";
  EXPECT_EQ(idl::TypeSupport<Message>::kIsKeyed, topic.qos.keyed) << name;
  EXPECT_TRUE(!topic.qos.keyed || (topic.qos.latched && topic.qos.depth == 1)) << name;
  EXPECT_GT(topic.qos.depth, 0) << name;
  EXPECT_EQ(name.find("//"), std::string::npos) << name;
  EXPECT_NE(name.back(), '/') << name;
}

template <class... Message>
void expect_all_sound(const dds::Topic<Message>&... topic) {
  (expect_sound(topic), ...);
}

TEST(TopicTable, RowsAreSound) {
  using namespace topics;  // NOLINT(google-build-using-namespace): the table's rows
  expect_all_sound(kClock, kTick, kAck, kColor, kCompressedColor, kDepth, kColorInfo, kDepthInfo, kLabels,
                   kLabelConfidence, kLabelInfo, kWheelOdometry, kImu, kGroundTruth, kCollision, kTransforms,
                   kStaticTransforms, kSlamOdometry, kTrackedFrame, kKeyframePath, kPoseGraph, kLandmarks,
                   kLandmarkState, kSlamStatus, kMapDescription, kVoxelTiles, kMapState, kObstacles, kOctomap,
                   kMapPoints, kOccupancyGrid, kPlannerPath, kGoal, kCandidates, kPlannerMarkers, kPlannerStatus,
                   kCommand, kTeleop, kLocalPath, kControllerStatus, kDiagnostics);
}

TEST(TopicTable, LockStepTopicsRepairLossQuickly) {
  EXPECT_TRUE(topics::kClock.qos.urgent && topics::kTick.qos.urgent && topics::kAck.qos.urgent);
  EXPECT_TRUE(topics::kColor.qos.urgent && topics::kSlamOdometry.qos.urgent && topics::kTrackedFrame.qos.urgent);
}

}  // namespace
}  // namespace lapis
