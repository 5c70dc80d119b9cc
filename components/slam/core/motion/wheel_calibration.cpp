#include "slam/core/motion/wheel_calibration.hpp"

#include <algorithm>
#include <cmath>

#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

constexpr double kLeastDistance_m = 0.05, kLeastTurn_rad = 0.05;

}  // namespace

WheelCalibrator::WheelCalibrator(const OdometryConfig& config) : config_(config) {
  belief_.distance_variance = belief_.turn_variance = squared(config.scale_sigma);
}

void WheelCalibrator::resume(const WheelCalibration& saved) {
  constexpr double kForgotten = 0.25;  // added sigma, as a share of the prior's
  belief_ = saved;
  belief_.distance_variance += squared(kForgotten * config_.scale_sigma);
  belief_.turn_variance += squared(kForgotten * config_.scale_sigma);
}

void WheelCalibrator::learn(const Walk& walk, const Pose& seen, const Matrix6d& covariance) {
  const Vector6d walked = geometry::se3_log(walk.T_from_to), truth = geometry::se3_log(seen);
  const double distance_m = walked.head<3>().norm(), turn_rad = walked.tail<3>().norm();
  if (distance_m >= kLeastDistance_m) {
    const Eigen::Vector3d along = walked.head<3>() / distance_m;
    learn(distance_m, along.dot(truth.head<3>()), along.dot(covariance.topLeftCorner<3, 3>() * along),
          squared(config_.distance_sigma) * walk.path_m, belief_.distance_scale, belief_.distance_variance);
  }
  if (turn_rad >= kLeastTurn_rad) {
    const Eigen::Vector3d axis = walked.tail<3>() / turn_rad;
    learn(turn_rad, axis.dot(truth.tail<3>()), axis.dot(covariance.bottomRightCorner<3, 3>() * axis),
          squared(config_.turn_sigma) * walk.turned_rad + squared(config_.turn_sigma_per_m) * walk.path_m,
          belief_.turn_scale, belief_.turn_variance);
  }
}

void WheelCalibrator::learn(double walked, double seen, double variance, double nominal, double& scale,
                            double& scale_variance) {
  const double error = seen - scale * walked;
  const double of_scale = squared(walked) * scale_variance;
  const double sigmas =
      std::min(kMostSigmas * std::max(1.0, belief_.noise), std::abs(error) / std::sqrt(variance + nominal + of_scale));
  belief_.motions += 1.0;
  const double mean_square = squared(belief_.noise) * (kPriorMotions + belief_.motions - 1.0) + squared(sigmas);
  belief_.noise = std::clamp(std::sqrt(mean_square / (kPriorMotions + belief_.motions)), 0.5, 5.0);

  const double innovation = variance + squared(belief_.noise) * nominal + of_scale;
  if (squared(error) > squared(kMostSigmas) * innovation) return;
  const double gain = scale_variance * walked / innovation;
  scale += gain * error;
  scale_variance = std::max(squared(kLeastSigma), scale_variance * (1.0 - gain * walked));
}

bool doubts_scale(const WheelCalibration& wheels) {
  constexpr double kMatters = 0.02, kSigmas = 5.0;
  const double off = std::abs(wheels.distance_scale - 1.0);
  return off >= kMatters && off > kSigmas * std::sqrt(wheels.distance_variance);
}

Pose corrected(const WheelCalibration& wheels, const Pose& motion) {
  Vector6d step = geometry::se3_log(motion);
  step.head<3>() *= wheels.distance_scale;
  step.tail<3>() *= wheels.turn_scale;
  return geometry::se3_exp(step);
}

}  // namespace lapis::slam
