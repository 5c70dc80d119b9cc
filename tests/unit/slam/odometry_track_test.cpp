#include "slam/core/motion/odometry_track.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "slam/core/motion/motion_model.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

time::Time at_s(double t_s) { return time::Time::from_seconds(100.0 + t_s); }

// An arc: 0.5 m/s forwards, 0.3 rad/s to the left.
Pose arc(double t_s) { return geometry::se3_exp(t_s * (Vector6d() << 0.5, 0.0, 0.0, 0.0, 0.0, 0.3).finished()); }

Pose somewhere() { return geometry::se3_exp((Vector6d() << 3.0, -1.0, 0.2, 0.1, -0.2, 2.0).finished()); }

OdometryTrack arc_track(const OdometryConfig& config = {}, double until_s = 4.0) {
  OdometryTrack track(config);
  for (int i = 0; 0.1 * i < until_s + 0.05; ++i) {
    EXPECT_TRUE(track.add(at_s(0.1 * i), somewhere() * arc(0.1 * i)));
  }
  return track;
}

TEST(OdometryTrack, MotionsAreInterpolatedAndDoNotDependOnTheFrame) {
  const OdometryTrack track = arc_track();
  const auto motion = track.between(at_s(0.537), at_s(3.211));
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->T_from_to.isApprox(arc(3.211 - 0.537), 1e-9));
  EXPECT_TRUE(track.pose_at(at_s(2.05))->isApprox(somewhere() * arc(2.05), 1e-9));
}

TEST(OdometryTrack, CarriesOnForHalfAGapAndNoFurther) {
  const OdometryTrack track = arc_track();
  EXPECT_TRUE(track.between(at_s(3.0), at_s(4.09))->T_from_to.isApprox(arc(1.09), 1e-9));
  EXPECT_FALSE(track.between(at_s(3.0), at_s(4.11)));
  EXPECT_FALSE(track.between(at_s(-0.01), at_s(1.0)));
  EXPECT_FALSE(track.between(at_s(2.0), at_s(1.0)));
  EXPECT_FALSE(OdometryTrack({}).between(at_s(0.0), at_s(0.0)));
}

TEST(OdometryTrack, VarianceGrowsWithThePathAlsoOnTheSpotAndBackwards) {
  OdometryConfig config;
  config.scale_sigma = 0.0;
  config.least_sigma = 1e-6;
  OdometryTrack track(config);
  for (int i = 0; i <= 40; ++i) {  // two metres forwards, two back
    const double x = i <= 20 ? 0.1 * i : 0.1 * (40 - i);
    track.add(at_s(0.1 * i), Pose(Eigen::Translation3d(x, 0.0, 0.0)));
  }
  const Matrix6d there = track.between(at_s(0.0), at_s(2.0))->covariance;
  const Matrix6d back = track.between(at_s(0.0), at_s(4.0))->covariance;
  EXPECT_NEAR(there(0, 0), config.distance_sigma * config.distance_sigma * 2.0, 1e-9);
  EXPECT_NEAR(back(0, 0), 2.0 * there(0, 0), 1e-9);
  EXPECT_NEAR(there(5, 5), config.turn_sigma_per_m * config.turn_sigma_per_m * 2.0, 1e-9);
  EXPECT_LT(there(2, 2), there(0, 0)) << "floors are flatter than wheels are round";
}

TEST(OdometryTrack, RefusesWhatCannotBeUsedAndBeginsAnewAfterAGap) {
  OdometryTrack track = arc_track();
  EXPECT_FALSE(track.add(at_s(4.0), arc(4.0))) << "same stamp";
  EXPECT_FALSE(track.add(at_s(3.5), arc(3.5))) << "earlier";
  Pose broken = arc(4.1);
  broken.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(track.add(at_s(4.1), broken));
  EXPECT_TRUE(track.between(at_s(1.0), at_s(4.0)));
  EXPECT_TRUE(track.add(at_s(4.5), arc(4.5)));
  EXPECT_FALSE(track.between(at_s(3.9), at_s(4.5))) << "nobody knows what happened in between";
  EXPECT_TRUE(track.add(at_s(4.6), arc(4.6)));
  EXPECT_TRUE(track.between(at_s(4.5), at_s(4.6))->T_from_to.isApprox(arc(0.1), 1e-9));
}

TEST(OdometryTrack, AJumpOfThePoseIsNoMotion) {
  OdometryTrack track = arc_track();
  EXPECT_TRUE(track.add(at_s(4.1), Pose::Identity())) << "the robot's odometry was set to zero";
  EXPECT_FALSE(track.between(at_s(3.9), at_s(4.1)));
  EXPECT_TRUE(track.add(at_s(4.2), arc(0.1)));
  EXPECT_TRUE(track.between(at_s(4.1), at_s(4.2))->T_from_to.isApprox(arc(0.1), 1e-9));
}

TEST(OdometryTrack, ASourceThatBeganAnewIsHeard) {
  OdometryTrack track = arc_track();
  EXPECT_TRUE(track.add(at_s(50.0), arc(50.0))) << "one stamp from the future";
  EXPECT_TRUE(track.add(at_s(4.1), arc(4.1)));
  EXPECT_TRUE(track.add(at_s(4.2), arc(4.2)));
  EXPECT_TRUE(track.between(at_s(4.1), at_s(4.2)));
}

TEST(OdometryTrack, ForgetsNothingThatIsStillNeeded) {
  OdometryTrack track = arc_track();
  track.forget_before(at_s(2.05));
  EXPECT_TRUE(track.between(at_s(2.05), at_s(4.0))->T_from_to.isApprox(arc(1.95), 1e-9));
  EXPECT_FALSE(track.between(at_s(1.9), at_s(4.0)));
}

TEST(Disagreement, CountsSigmasOfBothMeasurementsTogether) {
  OdometryMotion motion{somewhere(), Matrix6d::Identity() * 9e-4};
  const Matrix6d covariance = Matrix6d::Identity() * 16e-4;
  EXPECT_NEAR(disagreement(motion, somewhere(), covariance), 0.0, 1e-9);
  for (int i = 0; i < 6; ++i) {
    const Pose other = somewhere() * geometry::se3_exp(0.2 * Vector6d::Unit(i));
    EXPECT_NEAR(disagreement(motion, other, covariance), 4.0, 1e-6) << "0.2 of sqrt(0.03^2 + 0.04^2)";
  }
}

TEST(DeadReckoning, MovesTheCameraAsTheRobotMoves) {
  const Pose T_base_camera = geometry::se3_exp((Vector6d() << 0.1, 0.0, 1.0, -1.2, 1.2, -1.2).finished());
  MotionModel motion({}, T_base_camera);
  for (int i = 0; i <= 40; ++i) motion.add_odometry(at_s(0.1 * i), somewhere() * arc(0.1 * i));
  Map map;
  map.add_keyframe({});
  EXPECT_FALSE(motion.dead_reckon(at_s(1.0))) << "from where?";
  const Pose T_start = geometry::se3_exp((Vector6d() << 1.0, 2.0, 3.0, 0.3, 0.2, 0.1).finished());
  motion.update(map, at_s(1.0), {0, T_start, Matrix6d::Zero()});
  const auto reckoned = motion.dead_reckon(at_s(3.0));
  ASSERT_TRUE(reckoned);
  const Pose expected = T_start * T_base_camera.inverse() * arc(2.0) * T_base_camera;
  EXPECT_TRUE(reckoned->T_reference_camera.isApprox(expected, 1e-9));
  EXPECT_TRUE(motion.predict(map, at_s(3.0))->isApprox(expected, 1e-9)) << "further than constant velocity reaches";
  EXPECT_GT(reckoned->covariance.trace(), motion.dead_reckon(at_s(2.0))->covariance.trace());
  // A shift of the robot sideways is one of the camera in the direction that the mount turns it to.
  const Matrix6d move = geometry::adjoint(T_base_camera);
  const Matrix6d on_the_robot = move * reckoned->covariance * move.transpose();
  EXPECT_NEAR(on_the_robot(0, 1), 0.0, 1e-12);
}

}  // namespace
}  // namespace lapis::slam
