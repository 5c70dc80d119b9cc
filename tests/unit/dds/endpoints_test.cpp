// Names of ROS 2 on the wire, and the list of endpoints that discovery fills.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/dds/endpoints.hpp"
#include "idl/type_table.hpp"

namespace lapis::dds {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

Endpoint endpoint(std::uint8_t participant, std::uint8_t entity) {
  Endpoint made;
  made.gid[0] = participant;
  made.gid[15] = entity;
  return made;
}

TEST(RosNames, OfTopicsHaveThePrefixOfRos) {
  EXPECT_EQ(ros_topic_name("rt/slam/odometry"), "/slam/odometry");
  EXPECT_EQ(ros_topic_name("rq/planner/pauseRequest"), "");
  EXPECT_EQ(ros_topic_name("voxel_tiles"), "");
  EXPECT_EQ(ros_topic_name("ros_discovery_info"), "");
}

TEST(RosNames, OfTypesAreThoseOfTheTypeTable) {
  for (const idl::TypeEntry& type : idl::type_table()) {
    EXPECT_EQ(ros_type_name(std::string(type.dds_name)), type.ros_name);
    EXPECT_EQ(dds_type_name(std::string(type.ros_name)), type.dds_name);
  }
  EXPECT_EQ(ros_type_name("std_srvs::srv::dds_::Trigger_Request_"), "std_srvs/srv/Trigger_Request");
  for (const char* none : {"", "Strange", "a::dds_::", "::dds_::A_", "a::msg::A", "a::msg::dds_::A"}) {
    EXPECT_EQ(ros_type_name(none), "") << none;
  }
  for (const char* none : {"", "a", "a/b"}) EXPECT_EQ(dds_type_name(none), "") << none;
}

TEST(Endpoints, ComeAndGo) {
  Endpoints endpoints;
  endpoints.add(endpoint(1, 1));
  endpoints.add(endpoint(1, 2));
  endpoints.add(endpoint(2, 1));
  const std::uint64_t version = endpoints.version();
  EXPECT_THAT(endpoints.all(), SizeIs(3));
  endpoints.remove(endpoint(1, 2).gid);
  EXPECT_GT(endpoints.version(), version);
  endpoints.remove_participant(endpoint(1, 99).gid);
  EXPECT_THAT(endpoints.all(), SizeIs(1));
  endpoints.add(endpoint(2, 1));  // changed
  EXPECT_THAT(endpoints.all(), SizeIs(1));
  endpoints.remove_participant(endpoint(2, 0).gid);
  EXPECT_THAT(endpoints.all(), IsEmpty());
}

TEST(Endpoints, AnnounceTheHashOfTheirType) {
  Endpoint made;
  EXPECT_EQ(type_hash_of(made), "");
  made.user_data = "a=b;typehash=RIHS01_12;c=d;";
  EXPECT_EQ(type_hash_of(made), "RIHS01_12");
  made.user_data = "typehash=RIHS01_12";
  EXPECT_EQ(type_hash_of(made), "RIHS01_12");
}

}  // namespace
}  // namespace lapis::dds
