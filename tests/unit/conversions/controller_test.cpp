#include "controller/conversions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/messages/geometry.hpp"

namespace lapis::controller {
namespace {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

nav_msgs::msg::OccupancyGrid grid() {
  nav_msgs::msg::OccupancyGrid message;
  message.info().resolution(0.25f);
  message.info().width(3);
  message.info().height(2);
  message.info().origin().position().x(-1.0);
  message.info().origin().position().y(2.0);
  message.info().origin().orientation().w(1.0);
  message.data({-1, 0, 100, 0, 100, -1});
  return message;
}

TEST(ControllerConversions, PoseIsSeenFromAbove) {
  const Eigen::Quaterniond tilted(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                  Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitY()));
  const auto T = to_core(messages::to_message(geometry::make_pose({1.0, -2.0, 0.3}, tilted)));
  ASSERT_TRUE(T) << T.reason;
  EXPECT_TRUE(T->translation().isApprox(Eigen::Vector2d(1.0, -2.0)));
  EXPECT_NEAR(yaw_of(*T), 0.7, 1e-9);
}

TEST(ControllerConversions, PathComesBackAsItWas) {
  const std::vector<PlanarPose> path{planar_pose({0, 0}, 0.1), planar_pose({1, 2}, -3.0)};
  const auto back = to_core(to_message(path, {}));
  ASSERT_TRUE(back) << back.reason;
  ASSERT_EQ(back->size(), path.size());
  for (std::size_t i = 0; i < path.size(); ++i) EXPECT_TRUE((*back)[i].isApprox(path[i], 1e-12));
}

TEST(ControllerConversions, PathWithABadPoseIsRefused) {
  auto message = to_message({planar_pose({0, 0}, 0.0), planar_pose({1, 0}, 0.0)}, {});
  message.poses()[1].pose().position().x(kNaN);
  EXPECT_THAT(to_core(message).reason, HasSubstr("not finite"));
  message.poses()[1].pose().position().x(1e6);
  EXPECT_THAT(to_core(message).reason, HasSubstr("10 km"));
  message.poses()[1].pose(geometry_msgs::msg::Pose());  // no heading
  EXPECT_THAT(to_core(message).reason, HasSubstr("quaternion"));
}

TEST(ControllerConversions, GridKeepsItsCells) {
  const auto core = to_core(grid());
  ASSERT_TRUE(core) << core.reason;
  EXPECT_EQ(core->at({-0.4, 2.1}), 100);
  EXPECT_EQ(core->at({-0.9, 2.3}), 0);
  EXPECT_EQ(core->at({-0.9, 2.1}), -1);
  EXPECT_EQ(core->at({-0.2, 2.1}), -1) << "outside";
  EXPECT_EQ(core->at({-1.1, 2.1}), -1);
}

TEST(ControllerConversions, GridsThatMakeNoSenseAreRefusedButEmptyOnesAreNot) {
  auto message = grid();
  message.info().width(4);
  EXPECT_THAT(to_core(message).reason, HasSubstr("width x height"));
  message = grid();
  for (const float resolution : {0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN()}) {
    message.info().resolution(resolution);
    EXPECT_THAT(to_core(message).reason, HasSubstr("resolution"));
  }
  message = grid();
  message.info().origin().orientation().w(0.8);
  message.info().origin().orientation().z(0.6);
  EXPECT_THAT(to_core(message).reason, HasSubstr("turned"));
  EXPECT_TRUE(to_core(nav_msgs::msg::OccupancyGrid()));
}

TEST(ControllerConversions, StatusSaysWhatIsDecided) {
  const Decision decision{State::kBlocked, "a reason", {0.1, -0.2}, 3.5, {}};
  const auto message = to_message(decision, {});
  EXPECT_EQ(message.state(), lapis_msgs::msg::ControllerStatus_Constants::STATE_BLOCKED);
  EXPECT_EQ(message.reason(), "a reason");
  EXPECT_EQ(message.distance_to_goal_m(), 3.5);
  EXPECT_EQ(message.command().linear().x(), 0.1);
  EXPECT_EQ(message.command().angular().z(), -0.2);
  EXPECT_EQ(static_cast<int>(State::kIdle), lapis_msgs::msg::ControllerStatus_Constants::STATE_IDLE);
  EXPECT_EQ(static_cast<int>(State::kFollowing), lapis_msgs::msg::ControllerStatus_Constants::STATE_FOLLOWING);
  EXPECT_EQ(static_cast<int>(State::kStopped), lapis_msgs::msg::ControllerStatus_Constants::STATE_STOPPED);
}

TEST(ControllerConversions, OnlyNumbersAreFinite) {
  EXPECT_TRUE(is_finite({0.1, -0.2}));
  EXPECT_FALSE(is_finite({kNaN, 0.0}));
  EXPECT_FALSE(is_finite({0.0, std::numeric_limits<double>::infinity()}));
}

}  // namespace
}  // namespace lapis::controller
