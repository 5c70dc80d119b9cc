#include "slam/core/motion/wheel_calibration.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "slam/core/motion/odometry_track.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

// A robot that drives arcs of 0.3 m and up to 0.4 rad, which vision sees with 2 mm and 1 mrad, and its wheels with
// scales and noise that are wrong.
class Drive {
 public:
  Drive(double distance_scale, double turn_scale, double noise)
      : distance_scale_(distance_scale), turn_scale_(turn_scale), noise_(noise) {}

  void teach(WheelCalibrator& wheels, int motions) {
    for (int i = 0; i < motions; ++i) {
      const double x = 0.3, turn = std::uniform_real_distribution(-0.4, 0.4)(engine_);
      const Pose seen = motion(x + vision_m_ * normal(), turn + vision_rad_ * normal());
      const double noise_m = noise_ * config_.distance_sigma * std::sqrt(x);
      const double noise_rad =
          noise_ * std::hypot(config_.turn_sigma * std::sqrt(std::abs(turn)), config_.turn_sigma_per_m * std::sqrt(x));
      const Pose walked = motion(x / distance_scale_ + noise_m * normal(), turn / turn_scale_ + noise_rad * normal());
      wheels.learn({walked, x, std::abs(turn)}, seen, covariance());
    }
  }

 private:
  static Pose motion(double x, double turn) {
    return geometry::se3_exp((Vector6d() << x, 0.0, 0.0, 0.0, 0.0, turn).finished());
  }
  Matrix6d covariance() const {
    Matrix6d covariance = vision_m_ * vision_m_ * Matrix6d::Identity();
    covariance.bottomRightCorner<3, 3>() = vision_rad_ * vision_rad_ * Eigen::Matrix3d::Identity();
    return covariance;
  }
  double normal() { return normal_(engine_); }

  const OdometryConfig config_;
  const double vision_m_ = 0.002, vision_rad_ = 0.001;
  double distance_scale_, turn_scale_, noise_;
  std::mt19937 engine_{7};
  std::normal_distribution<double> normal_{0.0, 1.0};
};

TEST(WheelCalibrator, BeginsWithWhatIsConfigured) {
  OdometryConfig config;
  config.scale_sigma = 0.015;
  const WheelCalibration belief = WheelCalibrator(config).belief();
  EXPECT_EQ(belief.distance_scale, 1.0);
  EXPECT_NEAR(std::sqrt(belief.turn_variance), 0.015, 1e-12);
  EXPECT_EQ(belief.motions, 0.0);
}

// One measurement of a constant with a Gaussian prior has a closed form.
TEST(WheelCalibrator, OneMotionIsTheProductOfTwoGaussians) {
  OdometryConfig config;
  config.scale_sigma = 0.02;
  config.distance_sigma = 0.01;
  WheelCalibrator wheels(config);
  Matrix6d covariance = 1e-6 * Matrix6d::Identity();
  wheels.learn({Pose(Eigen::Translation3d(1.0, 0, 0)), 1.0, 0.0}, Pose(Eigen::Translation3d(1.01, 0, 0)), covariance);
  const double noise = wheels.belief().noise;
  const double of_motion = 1e-6 + noise * noise * 1e-4, of_prior = 4e-4;
  EXPECT_NEAR(wheels.belief().distance_scale, (1.0 / of_prior + 1.01 / of_motion) / (1.0 / of_prior + 1.0 / of_motion),
              1e-12);
  EXPECT_NEAR(wheels.belief().distance_variance, 1.0 / (1.0 / of_prior + 1.0 / of_motion), 1e-12);
  EXPECT_EQ(wheels.belief().turn_scale, 1.0) << "there was no turn";
}

TEST(WheelCalibrator, FindsWrongWheelsWithinItsOwnSigmas) {
  for (const auto& [distance, turn] : {std::pair(0.97, 1.03), {1.03, 0.97}, {1.0, 1.0}}) {
    WheelCalibrator wheels({});
    Drive(distance, turn, 1.0).teach(wheels, 200);
    const WheelCalibration& belief = wheels.belief();
    EXPECT_NEAR(belief.distance_scale, distance, 3.0 * std::sqrt(belief.distance_variance));
    EXPECT_NEAR(belief.turn_scale, turn, 3.0 * std::sqrt(belief.turn_variance));
    EXPECT_LT(std::sqrt(belief.distance_variance), 0.004);
    EXPECT_LT(std::sqrt(belief.turn_variance), 0.006);
  }
}

TEST(WheelCalibrator, DoubtsAScaleThatIsFarOffBeyondDoubt) {
  for (const auto& [distance, is_doubted] : {std::pair(0.96, true), {1.04, true}, {1.01, false}, {1.0, false}}) {
    WheelCalibrator wheels({});
    Drive(distance, 1.0, 1.0).teach(wheels, 3);
    EXPECT_FALSE(doubts_scale(wheels.belief())) << "not after three motions";
    Drive(distance, 1.0, 1.0).teach(wheels, 200);
    EXPECT_EQ(doubts_scale(wheels.belief()), is_doubted) << distance;
  }
}

TEST(WheelCalibrator, LearnsTheNoise) {
  WheelCalibrator quiet({}), noisy({});
  Drive(1.0, 1.0, 1.0).teach(quiet, 400);
  Drive(1.0, 1.0, 2.5).teach(noisy, 400);
  EXPECT_NEAR(quiet.belief().noise, 1.0, 0.15);
  EXPECT_NEAR(noisy.belief().noise, 2.5, 0.25);
}

TEST(WheelCalibrator, SlipSaysNothingOfTheScale) {
  WheelCalibrator wheels({});
  Drive(1.0, 1.0, 1.0).teach(wheels, 200);
  const WheelCalibration before = wheels.belief();
  wheels.learn({Pose(Eigen::Translation3d(1.0, 0, 0)), 1.0, 0.0}, Pose(Eigen::Translation3d(0.2, 0, 0)),
               1e-6 * Matrix6d::Identity());
  EXPECT_EQ(wheels.belief().distance_scale, before.distance_scale);
}

TEST(WheelCalibrator, ResumesALittleLessSure) {
  WheelCalibrator before({}), after({});
  Drive(0.97, 1.02, 1.0).teach(before, 300);
  after.resume(before.belief());
  EXPECT_EQ(after.belief().distance_scale, before.belief().distance_scale);
  EXPECT_GT(after.belief().distance_variance, before.belief().distance_variance);
  Drive(1.0, 1.0, 1.0).teach(after, 300);  // other tyres
  EXPECT_NEAR(after.belief().distance_scale, 1.0, 0.01);
}

TEST(WheelCalibrator, AStandingRobotTeachesNothing) {
  WheelCalibrator wheels({});
  wheels.learn({}, Pose(Eigen::Translation3d(0.001, 0, 0)), 1e-6 * Matrix6d::Identity());
  EXPECT_EQ(wheels.belief().motions, 0.0);
  EXPECT_EQ(wheels.belief().distance_scale, 1.0);
}

TEST(WheelCalibrator, CorrectsWhatFollows) {
  OdometryConfig config;
  OdometryTrack track(config);
  WheelCalibration wheels = WheelCalibrator(config).belief();
  wheels.distance_scale = 1.1;
  wheels.distance_variance = 0.0;
  const auto at = [](double t_s) { return time::Time::from_seconds(100.0 + t_s); };
  const auto x = [](double m) { return Pose(Eigen::Translation3d(m, 0, 0)); };
  for (int i = 0; i <= 20; ++i) {
    if (i == 11) track.calibrate(wheels);
    ASSERT_TRUE(track.add(at(0.1 * i), x(0.1 * i)));
  }
  EXPECT_NEAR(track.between(at(0.0), at(1.0))->T_from_to.translation().x(), 1.0, 1e-9);
  EXPECT_NEAR(track.between(at(1.0), at(2.0))->T_from_to.translation().x(), 1.1, 1e-9);
  EXPECT_NEAR(track.uncorrected_between(at(1.0), at(2.0))->T_from_to.translation().x(), 1.0, 1e-9);
  EXPECT_NEAR(track.pose_at(at(2.0))->translation().x(), 2.0, 1e-9) << "T_odom_base is what the wheels say";
  const double nominal = config.distance_sigma * config.distance_sigma + config.least_sigma * config.least_sigma;
  EXPECT_NEAR(track.between(at(1.0), at(2.0))->covariance(0, 0), 1.1 * nominal, 1e-6) << "no error of scale is left";
}

}  // namespace
}  // namespace lapis::slam
