#include "slam/core/pose_refiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "slam/core/frame.hpp"
#include "slam/core/noise_model.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

constexpr double kHuber = 2.0;  // sigmas up to which an error counts in full
constexpr double kPixelGate = 5.99, kDepthGate = 6.63;  // chi-square, 95 % of 2 and 99 % of 1 degrees of freedom
constexpr std::array kGateShare{1.0, 0.4, 0.2};         // of the widest surface gate, a round each

// Huber's cost and weight for a squared whitened error. Sec. 5.6 in [Zhang 1997]
double huber_cost(double squared) {
  const double error = std::sqrt(squared);
  return error <= kHuber ? 0.5 * squared : kHuber * (error - 0.5 * kHuber);
}
double huber_weight(double squared) { return squared <= kHuber * kHuber ? 1.0 : kHuber / std::sqrt(squared); }

// d(point in camera) / d(xi) for T_reference_camera * exp(xi): exp(-xi) * p = p - rho - omega x p.
Eigen::Matrix<double, 3, 6> point_jacobian(const Eigen::Vector3d& p_camera) {
  Eigen::Matrix<double, 3, 6> J;
  J << -Eigen::Matrix3d::Identity(), geometry::skew(p_camera);
  return J;
}

// Normal equations of one linearisation; points and surface apart, because their residual variances differ.
struct Term {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;
  double squares = 0.0;  // weighted sum of squared whitened residuals
  int residuals = 0;
};

struct Linearisation {
  Term points, surface;
  double surface_squares_m2 = 0.0;
  double cost() const { return points.cost + surface.cost; }
};

class Refinement {
 public:
  Refinement(const SlamConfig& config, const AlignmentProblem& problem)
      : config_(config), problem_(problem), is_inlier_(problem.points.size(), true) {}

  Linearisation linearise(const Pose& T, double gate_m) const {
    Linearisation result;
    add_points(T, result);
    if (problem_.depth != nullptr) add_surface(T, gate_m, result);
    return result;
  }

  // Levenberg-Marquardt on the current inliers.
  Pose optimise(Pose T, double gate_m) const {
    double damping = 1e-4;
    Linearisation current = linearise(T, gate_m);
    for (int i = 0; i < config_.tracker.refine_iterations; ++i) {
      Matrix6d H = current.points.hessian + current.surface.hessian;
      H.diagonal() += damping * H.diagonal() + Vector6d::Constant(1e-9);
      const Vector6d step = H.ldlt().solve(-(current.points.gradient + current.surface.gradient));
      if (!step.allFinite()) break;
      const Pose moved = T * geometry::se3_exp(step);
      const Linearisation next = linearise(moved, gate_m);
      if (next.cost() <= current.cost()) {
        T = moved;
        current = next;
        damping = std::max(1e-7, 0.1 * damping);
        if (step.norm() < 1e-5) break;
      } else {
        damping *= 10.0;
        if (step.norm() < 1e-5) break;
      }
    }
    return T;
  }

  void classify(const Pose& T) {
    for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
      const auto residual = point_residual(config_.noise, problem_.camera, problem_.points[i], T);
      is_inlier_[i] = residual && residual->value.head<2>().squaredNorm() < kPixelGate &&
                      residual->value.z() * residual->value.z() < kDepthGate;
    }
  }

  Alignment summarise(const Pose& T) const;

 private:
  void add_points(const Pose& T, Linearisation& result) const {
    for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
      if (!is_inlier_[i]) continue;
      const PointConstraint& point = problem_.points[i];
      const auto residual = point_residual(config_.noise, problem_.camera, point, T);
      if (!residual) continue;
      const double squared = residual->value.squaredNorm();
      const double weight = huber_weight(squared);
      Term& term = result.points;
      term.hessian.noalias() += weight * residual->jacobian.transpose() * residual->jacobian;
      term.gradient.noalias() += weight * residual->jacobian.transpose() * residual->value;
      term.cost += huber_cost(squared);
      term.squares += weight * squared;
      term.residuals += point.depth_m > 0.0 ? 3 : 2;
    }
  }

  void add_surface(const Pose& T, double gate_m, Linearisation& result) const {
    Term& term = result.surface;
    for (const SurfaceSample& sample : problem_.surface) {
      const auto residual = surface_residual(config_.noise, problem_.camera, *problem_.depth, sample, T);
      if (!residual || std::abs(residual->distance_m) > gate_m) continue;
      const double information = 1.0 / (residual->sigma_m * residual->sigma_m);
      const double squared = residual->distance_m * residual->distance_m * information;
      const double weight = config_.surface.weight * huber_weight(squared);
      // What counts is the gain over the gate's cost, so that dropping a sample never pays.
      const double gate_cost = huber_cost(gate_m * gate_m * information);
      term.hessian.noalias() += weight * information * residual->jacobian * residual->jacobian.transpose();
      term.gradient.noalias() += weight * information * residual->distance_m * residual->jacobian;
      term.cost += config_.surface.weight * (huber_cost(squared) - gate_cost);
      term.squares += weight * squared;
      result.surface_squares_m2 += residual->distance_m * residual->distance_m;
      ++term.residuals;
    }
  }

  const SlamConfig& config_;
  const AlignmentProblem& problem_;
  std::vector<bool> is_inlier_;
};

// J'WJ divided by the a-posteriori variance of the unit weight, as in any least-squares adjustment.
Matrix6d scaled_information(const Term& term, double effective_residuals) {
  if (effective_residuals <= 6.0) return Matrix6d::Zero();
  const double variance = std::max(term.squares / (effective_residuals - 6.0), 1e-4);
  return term.hessian / variance;
}

Alignment Refinement::summarise(const Pose& T) const {
  const Linearisation last = linearise(T, kGateShare.back() * config_.surface.max_distance_m);
  Alignment result;
  result.T_reference_camera = T;
  result.surface_information = scaled_information(last.surface, config_.surface.weight * last.surface.residuals);
  result.information = scaled_information(last.points, last.points.residuals) + result.surface_information;
  result.is_inlier = is_inlier_;
  result.inliers = static_cast<int>(std::count(is_inlier_.begin(), is_inlier_.end(), true));
  double squares = 0.0;
  for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
    if (!is_inlier_[i]) continue;
    const Eigen::Vector3d p = T.inverse() * problem_.points[i].p_reference;
    squares += (problem_.camera.project(p) - problem_.points[i].pixel).squaredNorm();
  }
  result.rms_px = result.inliers > 0 ? std::sqrt(squares / result.inliers) : 0.0;
  result.surface_matches = last.surface.residuals;
  if (result.surface_matches > 0) result.surface_rms_m = std::sqrt(last.surface_squares_m2 / result.surface_matches);
  return result;
}

}  // namespace

std::optional<PointResidual> point_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                            const PointConstraint& point, const Pose& T_reference_camera) {
  const Eigen::Vector3d p =
      T_reference_camera.linear().transpose() * (point.p_reference - T_reference_camera.translation());
  if (p.z() < noise.min_depth_m) return std::nullopt;
  const double inverse_z = 1.0 / p.z();
  Eigen::Matrix3d projection;  // d(u, v, z) / d(p)
  projection << camera.fx * inverse_z, 0.0, -camera.fx * p.x() * inverse_z * inverse_z,  //
      0.0, camera.fy * inverse_z, -camera.fy * p.y() * inverse_z * inverse_z,            //
      0.0, 0.0, 1.0;
  const Eigen::Vector2d pixel = camera.project(p);
  const double depth_weight = point.depth_m > 0.0 ? 1.0 / depth_sigma(noise, point.depth_m) : 0.0;
  const Eigen::Vector3d whitening(1.0 / point.sigma_px, 1.0 / point.sigma_px, depth_weight);
  PointResidual residual;
  residual.value = whitening.cwiseProduct(
      Eigen::Vector3d(pixel.x() - point.pixel.x(), pixel.y() - point.pixel.y(), p.z() - point.depth_m));
  residual.jacobian = whitening.asDiagonal() * projection * point_jacobian(p);
  return residual;
}

std::optional<SurfaceResidual> surface_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                                const geometry::DepthImage& depth, const SurfaceSample& sample,
                                                const Pose& T_reference_camera) {
  const Eigen::Matrix3d R_camera_reference = T_reference_camera.linear().transpose();
  const Eigen::Vector3d p_sample = R_camera_reference * (sample.point - T_reference_camera.translation());
  if (p_sample.z() < noise.min_depth_m) return std::nullopt;
  const Eigen::Vector2d pixel = camera.project(p_sample);
  const double depth_m = interpolate_depth(noise, depth, pixel);
  if (depth_m <= 0.0) return std::nullopt;
  const Eigen::Vector3d p = p_sample * (depth_m / p_sample.z());
  const Eigen::Vector3d normal = R_camera_reference * sample.normal;
  SurfaceResidual residual;
  residual.distance_m = normal.dot(p - p_sample);
  // A depth error moves the point along its ray (p / z); the plane distance sees the part along the normal.
  residual.sigma_m = depth_sigma(noise, depth_m) * std::max(0.2, std::abs(normal.dot(p)) / depth_m);
  // n' R (p + rho + omega x p): the frame's point moves, the sample stays.
  residual.jacobian << normal, p.cross(normal);
  return residual;
}

Alignment refine_pose(const SlamConfig& config, const AlignmentProblem& problem, const Pose& T_reference_camera) {
  Refinement refinement(config, problem);
  Pose T = T_reference_camera;
  for (const double share : kGateShare) {
    T = refinement.optimise(T, share * config.surface.max_distance_m);
    refinement.classify(T);
  }
  return refinement.summarise(T);
}

}  // namespace lapis::slam
