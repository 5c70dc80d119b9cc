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

constexpr double kHuber = 2.0;                          // sigmas up to which an error counts in full
constexpr double kPixelGate = 5.99, kDepthGate = 6.63;  // chi-square, 95 % of 2 and 99 % of 1 degrees of freedom
constexpr std::array kGateShare{1.0, 0.4, 0.2};         // of the widest surface gate, a round each

// Huber's cost and weight for a squared whitened error. Sec. 5.6 in [Zhang 1997]
double huber_cost(double squared) {
  const double error = std::sqrt(squared);
  return error <= kHuber ? 0.5 * squared : kHuber * (error - 0.5 * kHuber);
}
double huber_weight(double squared) { return squared <= kHuber * kHuber ? 1.0 : kHuber / std::sqrt(squared); }

// Gradient by xi of a function of the point in the camera, from its gradient by the point, for
// T_reference_camera * exp(xi): the point moves to exp(-xi) * p = p - rho - omega x p.
Vector6d by_pose(const Eigen::Vector3d& by_point, const Eigen::Vector3d& p_camera) {
  Vector6d gradient;
  gradient << -by_point, by_point.cross(p_camera);
  return gradient;
}

// Normal equations of one linearisation; points and surface apart, because their residual variances differ.
struct Term {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;
  double squares = 0.0;  // weighted sum of squared whitened residuals
  int residuals = 0;

  // Only the upper triangle of the Hessian is kept up to date.
  void add(const Vector6d& row, double residual, double weight) {
    for (int i = 0; i < 6; ++i) {
      const double scaled = weight * row[i];
      gradient[i] += scaled * residual;
      for (int j = i; j < 6; ++j) hessian(i, j) += scaled * row[j];
    }
    squares += weight * residual * residual;
  }
  Matrix6d full_hessian() const { return hessian.selfadjointView<Eigen::Upper>(); }
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
    const Pose T_camera_reference = T.inverse();
    add_points(T_camera_reference, result);
    if (problem_.depth != nullptr) add_surface(T_camera_reference, gate_m, result);
    return result;
  }

  // Levenberg-Marquardt on the current inliers.
  Pose optimise(Pose T, double gate_m) const {
    double damping = 1e-4;
    Linearisation current = linearise(T, gate_m);
    for (int i = 0; i < config_.tracker.refine_iterations; ++i) {
      Matrix6d H = (current.points.hessian + current.surface.hessian).selfadjointView<Eigen::Upper>();
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
    const Pose T_camera_reference = T.inverse();
    for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
      const auto residual = point_residual(config_.noise, problem_.camera, problem_.points[i], T_camera_reference);
      is_inlier_[i] = residual && residual->value.head<2>().squaredNorm() < kPixelGate &&
                      residual->value.z() * residual->value.z() < kDepthGate;
    }
  }

  Alignment summarise(const Pose& T) const;

 private:
  void add_points(const Pose& T_camera_reference, Linearisation& result) const {
    Term& term = result.points;
    for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
      if (!is_inlier_[i]) continue;
      const PointConstraint& point = problem_.points[i];
      const auto residual = point_residual(config_.noise, problem_.camera, point, T_camera_reference);
      if (!residual) continue;
      const double squared = residual->value.squaredNorm();
      const double weight = huber_weight(squared);
      for (int row = 0; row < 3; ++row) {
        term.add(residual->jacobian[static_cast<std::size_t>(row)], residual->value[row], weight);
      }
      term.cost += huber_cost(squared);
      term.residuals += point.depth_m > 0.0 ? 3 : 2;
    }
  }

  void add_surface(const Pose& T_camera_reference, double gate_m, Linearisation& result) const {
    Term& term = result.surface;
    for (const SurfaceSample& sample : problem_.surface) {
      const auto residual =
          surface_residual(config_.noise, problem_.camera, *problem_.depth, sample, T_camera_reference);
      if (!residual || std::abs(residual->distance_m) > gate_m) continue;
      const double information = 1.0 / (residual->sigma_m * residual->sigma_m);
      const double squared = residual->distance_m * residual->distance_m * information;
      const double weight = config_.surface.weight * huber_weight(squared);
      term.add(residual->jacobian, residual->distance_m, weight * information);
      // What counts is the gain over the gate's cost, so that dropping a sample never pays.
      term.cost += config_.surface.weight * (huber_cost(squared) - huber_cost(gate_m * gate_m * information));
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
  return term.full_hessian() / variance;
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
                                            const PointConstraint& point, const Pose& T_camera_reference) {
  const Eigen::Vector3d p = T_camera_reference * point.p_reference;
  if (p.z() < noise.min_depth_m) return std::nullopt;
  const double u_by_x = camera.fx / p.z();
  const double v_by_y = camera.fy / p.z();
  const double per_px = 1.0 / point.sigma_px;
  const double per_m = point.depth_m > 0.0 ? 1.0 / depth_sigma(noise, point.depth_m) : 0.0;
  PointResidual residual;
  residual.value = {per_px * (u_by_x * p.x() + camera.cx - point.pixel.x()),
                    per_px * (v_by_y * p.y() + camera.cy - point.pixel.y()), per_m * (p.z() - point.depth_m)};
  residual.jacobian[0] = by_pose({per_px * u_by_x, 0.0, -per_px * u_by_x * p.x() / p.z()}, p);
  residual.jacobian[1] = by_pose({0.0, per_px * v_by_y, -per_px * v_by_y * p.y() / p.z()}, p);
  residual.jacobian[2] = by_pose({0.0, 0.0, per_m}, p);
  return residual;
}

std::optional<SurfaceResidual> surface_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                                const geometry::DepthImage& depth, const SurfaceSample& sample,
                                                const Pose& T_camera_reference) {
  const Eigen::Vector3d p_sample = T_camera_reference * sample.point;
  if (p_sample.z() < noise.min_depth_m) return std::nullopt;
  const int u = static_cast<int>(std::floor(camera.fx * p_sample.x() / p_sample.z() + camera.cx + 0.5));
  const int v = static_cast<int>(std::floor(camera.fy * p_sample.y() / p_sample.z() + camera.cy + 0.5));
  if (u < 0 || v < 0 || u >= depth.width || v >= depth.height) return std::nullopt;
  const double depth_m = depth(u, v);
  if (!is_depth(noise, depth_m)) return std::nullopt;
  const Eigen::Vector3d p = camera.unproject(u, v, depth_m);
  const Eigen::Vector3d normal = T_camera_reference.linear() * sample.normal;
  SurfaceResidual residual;
  residual.distance_m = normal.dot(p - p_sample);
  // A depth error moves the point along its ray (p / z); the plane distance sees the part along the normal.
  residual.sigma_m = depth_sigma(noise, depth_m) * std::max(0.2, std::abs(normal.dot(p)) / depth_m);
  // Here the frame's point moves and the sample stays: the opposite sign of a point known in the reference.
  residual.jacobian = -by_pose(normal, p);
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
