#include "common/dds/names.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/lockstep.hpp"
#include "common/topics/map.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

const Names kRobot1{"robot1", {}};

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
  EXPECT_EQ(dds_name(topics::kSlamOdometry, kRobot1), "rt/robot1/slam/odometry");
  EXPECT_EQ(dds_name(topics::kVoxelTiles, kRobot1), "robot1/lapis/semantic_mapper/tiles");
  for (const auto& name : {dds_name(topics::kClock, kRobot1), dds_name(topics::kTick, kRobot1),
                           dds_name(topics::kAck, kRobot1), dds_name(topics::kTransforms, kRobot1),
                           dds_name(topics::kStaticTransforms, kRobot1), dds_name(topics::kDiagnostics, kRobot1)}) {
    EXPECT_EQ(name.find("robot1"), std::string::npos) << name;
  }
}

TEST(Names, RemappedOnesStayInTheNamespace) {
  const Names names{"robot1", {{"/slam/odometry", "/pose"}, {"/clock", "/time"}, {"map", "house/map"}}};
  EXPECT_EQ(dds_name(topics::kSlamOdometry, names), "rt/robot1/pose");
  EXPECT_EQ(dds_name(topics::kClock, names), "rt/time");
  EXPECT_EQ(dds_name(topics::kKeyframePath, names), "rt/robot1/slam/path");
  EXPECT_EQ(names.full("map"), "robot1/house/map");
  EXPECT_EQ(names.full("odom"), "robot1/odom");
}

TEST(Remaps, LastRuleForANameCounts) {
  const std::vector<std::string> known{"/a/b", "/c", "lapis/tiles", "map"};
  const auto remaps = parse_remaps({"/a/b:=/x", "map:=house/map", "lapis/tiles:=tiles_1", "/a/b:=/y/z_2"}, known);
  EXPECT_EQ(remaps,
            (std::map<std::string, std::string>{{"/a/b", "/y/z_2"}, {"map", "house/map"}, {"lapis/tiles", "tiles_1"}}));
}

TEST(Remaps, BadOnesAreNamedWithTheRemedy) {
  const auto problem = [](const std::string& rule) -> std::string {
    try {
      parse_remaps({rule}, {"/a/b", "map"});
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(problem("/a/b=/c"), ::testing::HasSubstr("write from:=to"));
  EXPECT_THAT(problem("/a:=/c"), ::testing::HasSubstr("no topic, service or frame of Lapis is called /a;"));
  for (const char* bad : {"/a/b:=", "/a/b:=c", "/a/b:=/", "/a/b:=/c/", "/a/b:=/1c", "/a/b:=/c d", "/a/b:=//c"}) {
    EXPECT_THAT(problem(bad), ::testing::HasSubstr("a topic or service needs")) << bad;
  }
  for (const char* bad : {"map:=", "map:=/map", "map:=a b"}) {
    EXPECT_THAT(problem(bad), ::testing::HasSubstr("a frame needs")) << bad;
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
