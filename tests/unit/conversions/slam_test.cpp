#include "slam/conversions.hpp"

#include <gtest/gtest.h>

#include <random>

#include "common/messages/geometry.hpp"
#include "common/messages/time.hpp"

namespace lapis::slam {
namespace {

const FrameIds kIds{"map", "odom", "base_link"};

geometry::Pose random_pose(std::mt19937& engine) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  geometry::Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = unit(engine);
  return geometry::se3_exp(xi);
}

FrameContext context_of(std::mt19937& engine) {
  FrameContext context;
  context.stamp = time::Time{12'345'678'901};
  context.optical_frame = "camera_color_optical_frame";
  context.session = 7;
  context.T_base_camera = random_pose(engine);
  return context;
}

TrackingResult tracking_result(std::mt19937& engine) {
  TrackingResult result;
  result.state = TrackingState::kTracking;
  result.keyframe_id = 3;
  result.graph_version = 9;
  result.T_map_keyframe = random_pose(engine);
  result.T_keyframe_camera = random_pose(engine);
  const geometry::Matrix6d A = geometry::Matrix6d::Random();
  result.map_covariance = 1e-4 * (A * A.transpose() + geometry::Matrix6d::Identity());
  return result;
}

TEST(SlamConversions, TrackedFrameCarriesBothPoses) {
  std::mt19937 engine(1);
  const auto context = context_of(engine);
  const auto result = tracking_result(engine);
  const auto message = to_tracked_frame(result, context, kIds);
  EXPECT_EQ(messages::from_message(message.header().stamp()), context.stamp);
  EXPECT_EQ(message.header().frame_id(), context.optical_frame);
  EXPECT_EQ(message.session(), 7);
  EXPECT_EQ(message.keyframe_id(), 3u);
  const auto T_map_keyframe = messages::from_message(message.keyframe_pose());
  const auto T_keyframe_camera = messages::from_message(message.pose_in_keyframe());
  ASSERT_TRUE(T_map_keyframe && T_keyframe_camera);
  EXPECT_TRUE(T_map_keyframe->isApprox(result.T_map_keyframe, 1e-12));
  EXPECT_TRUE(T_keyframe_camera->isApprox(result.T_keyframe_camera, 1e-12));
}

TEST(SlamConversions, LostFrameHasNoPoseThatCouldBeRead) {
  std::mt19937 engine(2);
  auto result = tracking_result(engine);
  result.state = TrackingState::kLost;
  result.reason = "12 inliers, 15 needed";
  const auto message = to_tracked_frame(result, context_of(engine), kIds);
  EXPECT_EQ(message.reason(), result.reason);
  EXPECT_FALSE(messages::from_message(message.keyframe_pose()));
  EXPECT_FALSE(messages::from_message(message.pose_in_keyframe()));
}

TEST(SlamConversions, AFrameInASubMapHasAPoseInItsKeyframeAlone) {
  std::mt19937 engine(2);
  auto result = tracking_result(engine);
  result.state = TrackingState::kUnconnected;
  const auto message = to_tracked_frame(result, context_of(engine), kIds);
  EXPECT_EQ(message.state(), lapis_msgs::msg::TrackedFrame_Constants::STATE_UNCONNECTED);
  EXPECT_EQ(message.keyframe_id(), 3u);
  EXPECT_FALSE(messages::from_message(message.keyframe_pose()));
  EXPECT_TRUE(messages::from_message(message.pose_in_keyframe()));
}

// Independent of the closed form: samples of the right perturbation at the camera, seen as changes of base_link's
// position and of its rotation about axes parallel to the map.
TEST(SlamConversions, OdometryCovarianceEqualsMonteCarlo) {
  std::mt19937 engine(3);
  std::normal_distribution<double> normal;
  const auto context = context_of(engine);
  const auto result = tracking_result(engine);
  const auto message = to_odometry(result, context, kIds);
  const geometry::Pose T_map_camera = result.T_map_keyframe * result.T_keyframe_camera;
  const geometry::Pose T_map_base = T_map_camera * context.T_base_camera.inverse();
  const geometry::Matrix6d L = result.map_covariance.llt().matrixL();
  geometry::Matrix6d sum = geometry::Matrix6d::Zero();
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    geometry::Vector6d xi;
    for (int k = 0; k < 6; ++k) xi[k] = normal(engine);
    const geometry::Pose sample = T_map_camera * geometry::se3_exp(L * xi) * context.T_base_camera.inverse();
    geometry::Vector6d change;
    change << sample.translation() - T_map_base.translation(),
        geometry::so3_log(sample.linear() * T_map_base.linear().transpose());
    sum += change * change.transpose();
  }
  const geometry::Matrix6d expected = sum / kSamples;
  const auto& covariance = message.pose().covariance();
  const double scale = expected.cwiseAbs().maxCoeff();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) {
      EXPECT_NEAR(covariance[static_cast<std::size_t>(6 * row + column)], expected(row, column), 0.05 * scale);
    }
  }
}

TEST(SlamConversions, TransformsComposeToTheOdometry) {
  std::mt19937 engine(4);
  const auto odometry = to_odometry(tracking_result(engine), context_of(engine), kIds);
  messages::StaticTransforms transforms;
  transforms.add(to_transforms(odometry, kIds));
  const auto T_map_base = transforms.find("map", "base_link");
  ASSERT_TRUE(T_map_base);
  EXPECT_TRUE(T_map_base->isApprox(*messages::from_message(odometry.pose().pose()), 1e-9));
}

TEST(SlamConversions, WithOdometryMapToOdomIsTheCorrection) {
  std::mt19937 engine(7);
  const auto odometry = to_odometry(tracking_result(engine), context_of(engine), kIds);
  const geometry::Pose T_odom_base = random_pose(engine);
  const auto message = to_correction(odometry, T_odom_base, kIds);
  ASSERT_EQ(message.transforms().size(), 1U);
  EXPECT_EQ(message.transforms()[0].header().frame_id(), "map");
  EXPECT_EQ(message.transforms()[0].child_frame_id(), "odom");
  const auto T_map_odom = messages::from_message(message.transforms()[0].transform());
  ASSERT_TRUE(T_map_odom);
  EXPECT_TRUE((*T_map_odom * T_odom_base).isApprox(*messages::from_message(odometry.pose().pose()), 1e-9));
}

TEST(SlamConversions, TwistIsTheMeanMotionInTheBodyFrame) {
  nav_msgs::msg::Odometry odometry;
  geometry::Vector6d step;
  step << 0.1, 0.0, 0.0, 0.0, 0.0, 0.05;
  set_twist(geometry::se3_exp(step), time::Duration::from_seconds(0.5), odometry);
  EXPECT_NEAR(odometry.twist().twist().linear().x(), 0.2, 1e-12);
  EXPECT_NEAR(odometry.twist().twist().angular().z(), 0.1, 1e-12);
}

TEST(SlamConversions, PoseGraphCarriesTheUpperTriangleRowByRow) {
  std::mt19937 engine(5);
  PoseGraphSnapshot graph;
  graph.version = 4;
  graph.nodes.push_back({1, time::Time{10}, random_pose(engine)});
  graph.nodes.push_back({2, time::Time{20}, random_pose(engine)});
  PoseGraphEdge edge{1, 2, EdgeType::kOdometry, random_pose(engine), geometry::Matrix6d::Zero()};
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column)
      edge.information(row, column) = 10 * std::min(row, column) + std::max(row, column);
  }
  graph.edges.push_back(edge);
  const auto message = to_message(graph, context_of(engine), kIds);
  EXPECT_EQ(message.version(), 4u);
  ASSERT_EQ(message.nodes().size(), 2u);
  ASSERT_EQ(message.edges().size(), 1u);
  const auto& information = message.edges()[0].information();
  EXPECT_EQ(information[0], 0.0);    // (0, 0)
  EXPECT_EQ(information[5], 5.0);    // (0, 5)
  EXPECT_EQ(information[6], 11.0);   // (1, 1)
  EXPECT_EQ(information[20], 55.0);  // (5, 5)
}

}  // namespace
}  // namespace lapis::slam
