#include "common/messages/geometry.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace lapis::messages {
namespace {

using geometry::Pose;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Pose random_pose(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-10.0, 10.0);
  const Eigen::Vector3d translation(number(random), number(random), number(random));
  return geometry::make_pose(
      translation, Eigen::Quaterniond(number(random), number(random), number(random), number(random)).normalized());
}

geometry_msgs::msg::TransformStamped link(const std::string& parent, const std::string& child, const Pose& T) {
  geometry_msgs::msg::TransformStamped message;
  message.header().frame_id(parent);
  message.child_frame_id(child);
  message.transform(to_transform(T));
  return message;
}

tf2_msgs::msg::TFMessage announce(const std::vector<geometry_msgs::msg::TransformStamped>& links) {
  tf2_msgs::msg::TFMessage message;
  message.transforms(links);
  return message;
}

TEST(PoseConversion, RoundTrips) {
  std::mt19937 random(3);
  for (int i = 0; i < 100; ++i) {
    const Pose T = random_pose(random);
    const auto pose = from_message(to_message(T));
    const auto transform = from_message(to_transform(T));
    ASSERT_TRUE(pose && transform);
    EXPECT_TRUE(pose->isApprox(T, 1e-12));
    EXPECT_TRUE(transform->isApprox(T, 1e-12));
  }
}

TEST(PoseConversion, RefusesNumbersThatAreNotFinite) {
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    auto position = to_message(Pose::Identity());
    position.position().y(bad);
    EXPECT_FALSE(from_message(position));
    EXPECT_EQ(from_message(position).reason, "pose has numbers that are not finite");
    auto orientation = to_message(Pose::Identity());
    orientation.orientation().z(bad);
    EXPECT_FALSE(from_message(orientation));
  }
}

TEST(PoseConversion, RefusesQuaternionsThatAreNoRotation) {
  geometry_msgs::msg::Pose unknown;  // all zero: "unknown" in our messages
  EXPECT_EQ(from_message(unknown).reason, "quaternion is not a unit one");
  auto stretched = to_message(Pose::Identity());
  stretched.orientation().w(1.01);
  EXPECT_FALSE(from_message(stretched));
}

TEST(PoseConversion, RoundedQuaternionBecomesAProperRotation) {
  auto message = to_message(Pose::Identity());
  message.orientation().w(1.0005);
  const auto T = from_message(message);
  ASSERT_TRUE(T);
  EXPECT_NEAR(T->linear().determinant(), 1.0, 1e-12);
}

TEST(Covariance, IsRowMajor) {
  geometry::Matrix6d covariance;
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) covariance(row, column) = 10.0 * row + column;
  }
  const auto out = to_row_major(covariance);
  for (std::size_t i = 0; i < 36; ++i) {
    const std::size_t row = i / 6, column = i % 6;
    EXPECT_EQ(out[i], 10.0 * static_cast<double>(row) + static_cast<double>(column));
  }
}

TEST(StaticTransforms, MultipliesAlongTheChainOfSeveralWriters) {
  std::mt19937 random(5);
  const Pose T_base_link = random_pose(random);
  const Pose T_link_optical = random_pose(random);
  StaticTransforms transforms;
  transforms.add(announce({link("camera_link", "optical", T_link_optical)}));
  EXPECT_FALSE(transforms.find("base_link", "optical"));
  transforms.add(announce({link("base_link", "camera_link", T_base_link)}));
  ASSERT_TRUE(transforms.find("base_link", "optical"));
  EXPECT_TRUE(transforms.find("base_link", "optical")->isApprox(T_base_link * T_link_optical, 1e-12));
  EXPECT_TRUE(transforms.find("optical", "optical")->isApprox(Pose::Identity()));
}

TEST(StaticTransforms, ConnectsTwoFramesThroughTheOneAboveBoth) {
  std::mt19937 random(7);
  const Pose T_link_color = random_pose(random), T_link_depth = random_pose(random), T_depth_imu = random_pose(random);
  StaticTransforms transforms;
  transforms.add(announce({link("camera_link", "color", T_link_color), link("camera_link", "depth", T_link_depth),
                           link("depth", "imu", T_depth_imu), link("arm", "hand", T_depth_imu)}));
  ASSERT_TRUE(transforms.find("color", "imu"));
  EXPECT_TRUE(transforms.find("color", "imu")->isApprox(T_link_color.inverse() * T_link_depth * T_depth_imu, 1e-12));
  ASSERT_TRUE(transforms.find("color", "camera_link"));
  EXPECT_TRUE(transforms.find("color", "camera_link")->isApprox(T_link_color.inverse(), 1e-12));
  EXPECT_FALSE(transforms.find("color", "hand"));
}

TEST(StaticTransforms, ACycleConnectsNothingElse) {
  StaticTransforms transforms;
  transforms.add(announce({link("a", "b", Pose::Identity()), link("b", "a", Pose::Identity())}));
  EXPECT_FALSE(transforms.find("c", "a"));
  EXPECT_FALSE(transforms.find("a", "c"));
}

TEST(StaticTransforms, LastAnnouncementOfAChildWins) {
  std::mt19937 random(6);
  const Pose first = random_pose(random);
  const Pose second = random_pose(random);
  StaticTransforms transforms;
  transforms.add(announce({link("base_link", "camera", first)}));
  transforms.add(announce({link("base_link", "camera", second)}));
  EXPECT_TRUE(transforms.find("base_link", "camera")->isApprox(second, 1e-12));
}

TEST(StaticTransforms, InventedFramesDoNotGrowWithoutEnd) {
  StaticTransforms transforms;
  const Pose T = Pose::Identity();
  EXPECT_EQ(transforms.add(announce({link("base_link", "camera", T)})), "");
  for (std::size_t i = 0; i + 1 < StaticTransforms::kMostFrames; ++i) {
    EXPECT_EQ(transforms.add(announce({link("a", "invented_" + std::to_string(i), T)})), "");
  }
  EXPECT_NE(transforms.add(announce({link("a", "one_more", T)})), "");
  EXPECT_FALSE(transforms.find("a", "one_more"));
  EXPECT_EQ(transforms.add(announce({link("base_link", "camera", T)})), "") << "known frames may change";
}

TEST(StaticTransforms, RingEnds) {
  StaticTransforms transforms;
  const Pose T = Pose::Identity();
  transforms.add(announce({link("a", "b", T), link("b", "c", T), link("c", "a", T), link("d", "d", T)}));
  EXPECT_FALSE(transforms.find("base_link", "a"));
  EXPECT_FALSE(transforms.find("base_link", "d"));
  EXPECT_TRUE(transforms.find("a", "c"));
}

TEST(StaticTransforms, TransformThatIsNoRotationIsNotTaken) {
  StaticTransforms transforms;
  auto bad = link("base_link", "camera", Pose::Identity());
  bad.transform().rotation().w(0.0);
  EXPECT_NE(transforms.add(announce({bad})), "");
  EXPECT_FALSE(transforms.find("base_link", "camera"));
  EXPECT_EQ(transforms.add(announce({link("base_link", "camera", Pose::Identity())})), "");
}

}  // namespace
}  // namespace lapis::messages
