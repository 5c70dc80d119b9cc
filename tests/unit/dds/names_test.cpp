#include "common/dds/names.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/map.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"

#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

TEST(Names, FollowRos2Mangling) {
  EXPECT_EQ(topic_dds_name("/slam/odometry"), "rt/slam/odometry");
  EXPECT_EQ(topic_dds_name("lapis/semantic_mapper/tiles"), "lapis/semantic_mapper/tiles");
  EXPECT_EQ(request_dds_name("/planner/start"), "rq/planner/startRequest");
  EXPECT_EQ(reply_dds_name("/planner/start"), "rr/planner/startReply");
}

TEST(Names, NamespaceGoesInFront) {
  EXPECT_EQ(in_namespace("/slam/odometry", ""), "/slam/odometry");
  EXPECT_EQ(in_namespace("/slam/odometry", "robot1"), "/robot1/slam/odometry");
  EXPECT_EQ(in_namespace("/slam/odometry", "fleet/robot1"), "/fleet/robot1/slam/odometry");
  EXPECT_EQ(in_namespace("lapis/semantic_mapper/tiles", "robot1"), "robot1/lapis/semantic_mapper/tiles");
}

TEST(Names, GlobalTopicsStay) {
  EXPECT_EQ(dds_name(topics::kSlamOdometry, "robot1"), "rt/robot1/slam/odometry");
  EXPECT_EQ(dds_name(topics::kVoxelTiles, "robot1"), "robot1/lapis/semantic_mapper/tiles");
  for (const auto& name : {dds_name(topics::kClock, "robot1"), dds_name(topics::kTick, "robot1"),
                           dds_name(topics::kAck, "robot1"), dds_name(topics::kTransforms, "robot1"),
                           dds_name(topics::kStaticTransforms, "robot1"), dds_name(topics::kDiagnostics, "robot1")}) {
    EXPECT_EQ(name.find("robot1"), std::string::npos) << name;
  }
}

TEST(Names, NamespaceIsCheckedAsInRos2) {
  for (const char* good : {"", "robot1", "_x", "fleet/robot_1", "A"}) EXPECT_NO_THROW(check_namespace(good)) << good;
  for (const char* bad :
       {"/robot1", "robot1/", "robot 1", "1robot", "fleet//robot", "fleet/1", "röbot", "robot-1", "/"}) {
    EXPECT_THROW(check_namespace(bad), std::runtime_error) << bad;
  }
}

}  // namespace
}  // namespace lapis::dds
