#include "slam/core/tracking/surface_tracker.hpp"

#include <gtest/gtest.h>

#include "slam/core/frame/surface.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

Pose step(double x, double y, double z, double rx, double ry, double rz) {
  return geometry::se3_exp((Vector6d() << x, y, z, rx, ry, rz).finished());
}

/// Standard deviations of the same size in all directions.
Matrix6d covariance(double sigma_m, double sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(sigma_m * sigma_m), Eigen::Vector3d::Constant(sigma_rad * sigma_rad);
  return variances.asDiagonal();
}

class SurfaceTrackerTest : public ::testing::Test {
 protected:
  void add_keyframe(const RgbdFrame& frame, const Pose& T_map_camera) {
    Keyframe keyframe;
    keyframe.camera = frame.camera;
    keyframe.T_map_camera = T_map_camera;
    keyframe.surface = sample_surface(config_.surface, config_.noise, frame.camera, frame.depth);
    map_.add_keyframe(std::move(keyframe));
  }
  TrackOutcome track(const RgbdFrame& input, const Pose& expected, double sigma_m, double sigma_rad) {
    Frame frame;
    frame.input = &input;
    return SurfaceTracker(config_).track(map_, frame, 0, {expected, covariance(sigma_m, sigma_rad)});
  }
  Pose T_map_camera(const TrackOutcome& outcome) const {
    return map_.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera;
  }
  static Vector6d error(const Pose& truth, const Pose& estimate) {
    return geometry::se3_log(truth.inverse() * estimate);
  }

  SlamConfig config_;
  Map map_;
  geometry::PinholeCamera camera_ = test::small_camera();
};

TEST_F(SurfaceTrackerTest, ARoomCornerTellsEveryDirection) {
  const Pose first = step(0.5, 0.4, 0.3, 0.3, 0.6, 0.0), second = first * step(0.03, -0.02, 0.02, 0.01, -0.015, 0.01);
  add_keyframe(test::render_room(camera_, first, {}), first);
  const RgbdFrame frame = test::render_room(camera_, second, {});
  const TrackOutcome outcome = track(frame, second * step(0.02, 0.02, -0.02, 0.01, 0.01, -0.01), 0.02, 0.01);
  ASSERT_TRUE(outcome.is_tracked) << outcome.reason;
  EXPECT_TRUE(outcome.inliers.empty());
  EXPECT_LT(error(second, T_map_camera(outcome)).head<3>().norm(), 0.002);
  EXPECT_LT(error(second, T_map_camera(outcome)).tail<3>().norm(), 0.001);
  EXPECT_EQ(outcome.alignment.information.fullPivLu().rank(), 6);
}

TEST_F(SurfaceTrackerTest, AWallLeavesThePathAlongItToMotion) {
  RgbdFrame wall{{}, camera_, {}, geometry::DepthImage(camera_.width, camera_.height, 2.0F)};
  add_keyframe(wall, Pose::Identity());
  wall.depth = geometry::DepthImage(camera_.width, camera_.height, 1.97F);
  // It drove 3 cm towards the wall and 5 cm aside; motion says 1 cm and 6 cm.
  const TrackOutcome outcome = track(wall, step(0.06, 0.0, 0.01, 0.0, 0.0, 0.02), 0.01, 0.01);
  ASSERT_TRUE(outcome.is_tracked) << outcome.reason;
  const Vector6d found = geometry::se3_log(outcome.alignment.T_reference_camera);
  EXPECT_NEAR(found[0], 0.06, 1e-3) << "aside: as expected";
  EXPECT_NEAR(found[1], 0.0, 1e-3);
  EXPECT_NEAR(found[2], 0.03, 1e-3) << "towards the wall: as the wall says";
  EXPECT_NEAR(found[5], 0.02, 1e-3) << "about the normal: as expected";
  const Matrix6d& information = outcome.alignment.information;
  for (const int open : {0, 1, 5}) EXPECT_NEAR(information(open, open), 0.0, 1e-6 * information(2, 2)) << open;
  for (const int known : {2, 3, 4}) EXPECT_GT(information(known, known), 1e4) << known;
}

TEST_F(SurfaceTrackerTest, SurfacesThatContradictMotionAreNotBelieved) {
  RgbdFrame wall{{}, camera_, {}, geometry::DepthImage(camera_.width, camera_.height, 2.0F)};
  add_keyframe(wall, Pose::Identity());
  wall.depth = geometry::DepthImage(camera_.width, camera_.height, 1.94F);
  const TrackOutcome outcome = track(wall, Pose::Identity(), 0.002, 0.002);
  EXPECT_FALSE(outcome.is_tracked);
  EXPECT_EQ(outcome.reason, "surfaces and motion contradict each other");
  EXPECT_TRUE(track(wall, Pose::Identity(), 0.05, 0.002).is_tracked) << "when motion is not so sure";
}

TEST_F(SurfaceTrackerTest, SurfacesThatNobodySawAreOfNoUse) {
  const Pose first = step(0.5, 0.4, 0.3, 0.3, 0.6, 0.0);
  add_keyframe(test::render_room(camera_, first, {}), first);
  const Pose turned = first * step(0, 0, 0, 0, 1.8, 0);
  const TrackOutcome outcome = track(test::render_room(camera_, turned, {}), turned, 0.02, 0.02);
  EXPECT_FALSE(outcome.is_tracked);
  EXPECT_EQ(outcome.reason, "no key-frame has seen these surfaces");
  RgbdFrame other{{}, camera_, {}, geometry::DepthImage(camera_.width, camera_.height, 0.4F)};
  EXPECT_EQ(track(other, first, 0.02, 0.02).reason, "too little of the near surfaces is seen again");
}

}  // namespace
}  // namespace lapis::slam
