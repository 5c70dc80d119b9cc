#include "slam/core/mapping/bundle_adjuster.hpp"

#include <algorithm>
#include <array>

#include <ceres/ceres.h>
#include <Eigen/Eigenvalues>

#include "slam/core/tracking/pose_refiner.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

constexpr double kPointHuber = 2.0;  // sigmas up to which an observation counts in full
constexpr double kLinkHuber = 3.55;  // the same for a link: 95 % quantile of 6 degrees of freedom

// A pose as a parameter block of Ceres: x y z qx qy qz qw.
using PoseBlock = std::array<double, 7>;
using RowMajor37 = Eigen::Matrix<double, 3, 7, Eigen::RowMajor>;
using RowMajor33 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor67 = Eigen::Matrix<double, 6, 7, Eigen::RowMajor>;

PoseBlock to_block(const Pose& T) {
  const Eigen::Quaterniond q = geometry::unit_quaternion(T);
  return {T.translation().x(), T.translation().y(), T.translation().z(), q.x(), q.y(), q.z(), q.w()};
}

Pose to_pose(const double* block) {
  return geometry::make_pose(Eigen::Vector3d(block), Eigen::Quaterniond(block[6], block[3], block[4], block[5]));
}

// SE(3) with right perturbation. Cost functions put their Jacobian by the tangent into the first six columns of the
// ambient one, so PlusJacobian only has to pass these on; the ambient Jacobian is never used alone.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    const PoseBlock moved = to_block(to_pose(x) * geometry::se3_exp(Eigen::Map<const Vector6d>(delta)));
    std::copy(moved.begin(), moved.end(), x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> J(jacobian);
    J.setZero();
    J.topRows<6>().setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    Eigen::Map<Vector6d> delta(y_minus_x);
    delta = geometry::se3_log(to_pose(x).inverse() * to_pose(y));
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<RowMajor67> J(jacobian);
    J.setZero();
    J.leftCols<6>().setIdentity();
    return true;
  }
};

class ObservationCost final : public ceres::SizedCostFunction<3, 7, 3> {
 public:
  ObservationCost(const NoiseConfig& noise, const geometry::PinholeCamera& camera, const BundleObservation& observation)
      : noise_(noise), camera_(camera), observation_(observation) {}

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Eigen::Matrix<double, 3, 6> by_pose;
    Eigen::Matrix3d by_point;
    Eigen::Vector3d residual;
    const bool in_front = bundle_residual(noise_, camera_, observation_, to_pose(parameters[0]),
                                          Eigen::Vector3d(parameters[1]), residual, &by_pose, &by_point);
    if (!in_front) return false;
    Eigen::Map<Eigen::Vector3d>(residuals, 3) = residual;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor37>(jacobians[0]) << by_pose, Eigen::Vector3d::Zero();
    if (jacobians[1] != nullptr) Eigen::Map<RowMajor33>(jacobians[1], 3, 3) = by_point;
    return true;
  }

 private:
  const NoiseConfig& noise_;
  const geometry::PinholeCamera& camera_;
  const BundleObservation& observation_;
};

class LinkCost final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit LinkCost(const BundleLink& link) : link_(link) {
    const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(link.information);
    root_ = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal() * solver.eigenvectors().transpose();
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    Matrix6d by_from;
    Matrix6d by_to;
    const Vector6d error = link_error(link_, to_pose(parameters[0]), to_pose(parameters[1]), &by_from, &by_to);
    Eigen::Map<Vector6d>(residuals, 6) = root_ * error;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) Eigen::Map<RowMajor67>(jacobians[0]) << root_ * by_from, Vector6d::Zero();
    if (jacobians[1] != nullptr) Eigen::Map<RowMajor67>(jacobians[1]) << root_ * by_to, Vector6d::Zero();
    return true;
  }

 private:
  const BundleLink& link_;
  Matrix6d root_;
};

ceres::Solver::Options solver_options(const BundleConfig& config) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = config.max_iterations;
  options.num_threads = 1;
  options.logging_type = ceres::SILENT;
  options.function_tolerance = 1e-4;
  options.max_solver_time_in_seconds = 1e9;  // wall time must not decide the result
  return options;
}

}  // namespace

bool bundle_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                     const BundleObservation& observation, const Pose& T_map_camera, const Eigen::Vector3d& p_map,
                     Eigen::Vector3d& residual, Eigen::Matrix<double, 3, 6>* by_pose, Eigen::Matrix3d* by_point) {
  const PointConstraint point{p_map, observation.pixel, observation.depth_m, observation.sigma_px};
  const auto result = point_residual(noise, camera, point, T_map_camera.inverse());
  if (!result) return false;
  residual = result->value;
  for (int row = 0; row < 3; ++row) {
    const geometry::Vector6d& gradient = result->jacobian[static_cast<std::size_t>(row)];
    if (by_pose != nullptr) by_pose->row(row) = gradient.transpose();
    // p_camera = R' (p_map - t), and the pose's translation columns are d(residual)/d(p_camera) * (-I).
    if (by_point != nullptr) by_point->row(row) = -gradient.head<3>().transpose() * T_map_camera.linear().transpose();
  }
  return true;
}

Vector6d link_error(const BundleLink& link, const Pose& T_map_from, const Pose& T_map_to, Matrix6d* by_from,
                    Matrix6d* by_to) {
  const Pose T_from_to = T_map_from.inverse() * T_map_to;
  Vector6d error = geometry::se3_log(link.T_from_to.inverse() * T_from_to);
  // log(E exp(xi)) = e + Jr^-1(e) xi with Jr^-1 = I + ad(e)/2 + ad(e)^2/12 up to O(|e|^4): errors are small.
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = geometry::skew(error.tail<3>());
  ad.topRightCorner<3, 3>() = geometry::skew(error.head<3>());
  ad.bottomRightCorner<3, 3>() = ad.topLeftCorner<3, 3>();
  const Matrix6d inverse_jacobian = Matrix6d::Identity() + 0.5 * ad + ad * ad / 12.0;
  if (by_to != nullptr) *by_to = inverse_jacobian;
  if (by_from != nullptr) *by_from = -inverse_jacobian * geometry::adjoint(T_from_to.inverse());
  return error;
}

BundleReport adjust_bundle(const BundleConfig& config, const NoiseConfig& noise, BundleProblem& problem) {
  std::vector<PoseBlock> poses;
  for (const BundleCamera& camera : problem.cameras) poses.push_back(to_block(camera.T_map_camera));
  std::vector<Eigen::Vector3d> points = problem.points_map;

  ceres::Problem solver;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    solver.AddParameterBlock(poses[i].data(), 7, new PoseManifold);
    if (problem.cameras[i].is_fixed) solver.SetParameterBlockConstant(poses[i].data());
  }
  for (const BundleObservation& observation : problem.observations) {
    const auto& [camera, T_map_camera, is_fixed] = problem.cameras[observation.camera];
    Eigen::Vector3d residual;
    if (!bundle_residual(noise, camera, observation, T_map_camera, points[observation.point], residual, nullptr,
                         nullptr)) {
      continue;
    }
    solver.AddResidualBlock(new ObservationCost(noise, camera, observation), new ceres::HuberLoss(kPointHuber),
                            poses[observation.camera].data(), points[observation.point].data());
  }
  for (const BundleLink& link : problem.links) {
    solver.AddResidualBlock(new LinkCost(link), new ceres::HuberLoss(kLinkHuber), poses[link.from].data(),
                            poses[link.to].data());
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver_options(config), &solver, &summary);

  const BundleReport report{summary.IsSolutionUsable(), summary.initial_cost, summary.final_cost,
                            static_cast<int>(summary.iterations.size())};
  if (!report.is_usable) return report;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (!problem.cameras[i].is_fixed) problem.cameras[i].T_map_camera = to_pose(poses[i].data());
  }
  problem.points_map = std::move(points);
  return report;
}

}  // namespace lapis::slam
