// The two places that name a type agree: the compile-time traits and the run-time table.
#include "idl/type_support.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <type_traits>

#include "idl/builtin_interfaces.hpp"
#include "idl/diagnostic_msgs.hpp"
#include "idl/geometry_msgs.hpp"
#include "idl/lapis_msgs.hpp"
#include "idl/nav_msgs.hpp"
#include "idl/octomap_msgs.hpp"
#include "idl/rcl_interfaces.hpp"
#include "idl/rmw_dds_common.hpp"
#include "idl/rosgraph_msgs.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/std_msgs.hpp"
#include "idl/std_srvs.hpp"
#include "idl/tf2_msgs.hpp"
#include "idl/type_table.hpp"
#include "idl/vision_msgs.hpp"
#include "idl/visualization_msgs.hpp"

namespace lapis::idl {
namespace {

template <typename T>
class EveryPackage : public testing::Test {};

using Types =
    testing::Types<builtin_interfaces::msg::Time, diagnostic_msgs::msg::DiagnosticArray, geometry_msgs::msg::Twist,
                   lapis_msgs::msg::Ack, lapis_msgs::msg::CandidateSet, lapis_msgs::msg::ControllerStatus,
                   lapis_msgs::msg::LandmarkState, lapis_msgs::msg::LandmarkTile, lapis_msgs::msg::MapState,
                   lapis_msgs::msg::PlannerStatus, lapis_msgs::msg::PoseGraph, lapis_msgs::msg::SlamStatus,
                   lapis_msgs::msg::Tick, lapis_msgs::msg::TrackedFrame, lapis_msgs::msg::VoxelTile,
                   nav_msgs::msg::Odometry, nav_msgs::srv::GetMap_Response, octomap_msgs::msg::Octomap,
                   octomap_msgs::srv::GetOctomap_Response, rcl_interfaces::msg::ParameterEvent,
                   rcl_interfaces::srv::DescribeParameters_Response, rmw_dds_common::msg::ParticipantEntitiesInfo,
                   rosgraph_msgs::msg::Clock, sensor_msgs::msg::Image, sensor_msgs::msg::PointCloud2,
                   std_msgs::msg::Empty, std_msgs::msg::Header, std_srvs::srv::Trigger_Request,
                   tf2_msgs::msg::TFMessage, vision_msgs::msg::LabelInfo, visualization_msgs::msg::MarkerArray>;
TYPED_TEST_SUITE(EveryPackage, Types);

TYPED_TEST(EveryPackage, AgreesOnNamesAndHash) {
  using Support = TypeSupport<TypeParam>;
  const TypeEntry* entry = find(Support::kRosName);
  ASSERT_NE(entry, nullptr);
  EXPECT_EQ(entry->dds_name, Support::kDdsName);
  EXPECT_EQ(entry->hash, Support::kHash);
}

TEST(TypeTable, IsSortedAndFindsEachOfItsNames) {
  const auto table = type_table();
  EXPECT_GT(table.size(), 100U);
  EXPECT_TRUE(std::ranges::is_sorted(table, std::ranges::less_equal(), &TypeEntry::ros_name));
  for (const TypeEntry& entry : table) EXPECT_EQ(find(entry.ros_name), &entry);
  for (const std::string_view name : {"", "a", "std_msgs/msg/Heade", "std_msgs/msg/Header2", "zzz"}) {
    EXPECT_EQ(find(name), nullptr) << name;
  }
}

TEST(TypeTable, HoldsSchemas) {
  EXPECT_EQ(find("std_msgs/msg/Header")->ros2msg_text,
            "builtin_interfaces/Time stamp\nstring frame_id\n" + std::string(80, '=') +
                "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n");
}

TEST(ServiceSupport, NamesRequestAndResponse) {
  using Support = ServiceSupport<std_srvs::srv::Trigger>;
  static_assert(std::is_same_v<Support::Request, std_srvs::srv::Trigger_Request>);
  static_assert(std::is_same_v<Support::Response, std_srvs::srv::Trigger_Response>);
  EXPECT_STREQ(Support::kRosName, "std_srvs/srv/Trigger");
  EXPECT_STREQ(Support::kHash, "RIHS01_eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f");
}

TEST(Messages, KeepRosMemberNamesThatIdlReserves) {
  octomap_msgs::srv::GetOctomap_Response response;
  response.map().id("OcTree");
  EXPECT_EQ(response.map().id(), "OcTree");
}

}  // namespace
}  // namespace lapis::idl
