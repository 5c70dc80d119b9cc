#include "slam/core/tracking/pose_refiner.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "slam/core/frame/frame.hpp"
#include "slam/core/frame/noise_model.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

constexpr double kHuber = 2.0;                          // sigmas up to which an error counts in full
constexpr double kPixelGate = 5.99, kDepthGate = 6.63;  // chi-square, 95 % of 2 and 99 % of 1 degrees of freedom

// A round of the refinement. The first ones only have to bring the pose close, so every `stride`th sample is enough; 0:
// none counts.
struct Round {
  double gate_share;  // of SurfaceConfig::max_distance_m
  std::size_t stride;
  double least_step;  // [m], [rad]; smaller ones end the round
};
constexpr Round kPoints{0.0, 0, 1e-3};
constexpr std::array kRounds{Round{1.0, 4, 1e-3}, Round{0.4, 2, 1e-3}, Round{0.2, 1, 1e-5}};

// Huber's cost and weight for the length of a whitened error. Sec. 5.6 in [Zhang 1997]
double huber_cost(double error) { return error <= kHuber ? 0.5 * error * error : kHuber * (error - 0.5 * kHuber); }
double huber_weight(double error) { return error <= kHuber ? 1.0 : kHuber / error; }

// Gradient by xi of a function of the point in the camera, from its gradient by the point, for
// T_reference_camera * exp(xi): the point moves to exp(-xi) * p = p - rho - omega x p.
Vector6d by_pose(const Eigen::Vector3d& by_point, const Eigen::Vector3d& p_camera) {
  const Eigen::Vector3d turn = by_point.cross(p_camera);
  return Vector6d{-by_point.x(), -by_point.y(), -by_point.z(), turn.x(), turn.y(), turn.z()};
}

// Normal equations of one linearisation; points and surface are separate, because their residual variances differ.
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
  Term points, surface, prior;
  double surface_squares_m2 = 0.0;
  double cost() const { return points.cost + surface.cost + prior.cost; }
};

// The a-posteriori variance of the unit weight, as in any least-squares adjustment.
double unit_variance(const Term& term, double effective_residuals) {
  return std::max(term.squares / (effective_residuals - 6.0), 1e-4);
}

Matrix6d scaled_information(const Term& term, double effective_residuals) {
  if (effective_residuals <= 6.0) return Matrix6d::Zero();
  return term.full_hessian() / unit_variance(term, effective_residuals);
}

class Refinement {
 public:
  Refinement(const SlamConfig& config, const AlignmentProblem& problem, const Pose& T_reference_camera)
      : config_(config), problem_(problem), T_(T_reference_camera), is_inlier_(problem.points.size(), true),
        is_doubted_(problem.surface.size(), false) {
    if (!starts_with_points()) return;
    std::transform(problem.points.begin(), problem.points.end(), is_inlier_.begin(),
                   [](const PointConstraint& point) { return point.is_confirmed; });
  }

  bool starts_with_points() const { return has_witnesses(config_.tracker, problem_.points); }

  // Levenberg-Marquardt on the current inliers.
  void optimise(const Round& round) {
    double damping = 1e-4;
    last_ = linearise(T_, round);
    for (int i = 0; i < config_.tracker.refine_iterations; ++i) {
      const Matrix6d measured = last_.points.hessian + last_.surface.hessian + last_.prior.hessian;
      Matrix6d H = measured.selfadjointView<Eigen::Upper>();
      H.diagonal() += damping * H.diagonal() + Vector6d::Constant(1e-9);
      const Vector6d step = H.ldlt().solve(-(last_.points.gradient + last_.surface.gradient + last_.prior.gradient));
      if (!step.allFinite()) break;
      const Pose moved = T_ * geometry::se3_exp(step);
      const Linearisation next = linearise(moved, round);
      if (next.cost() <= last_.cost()) {
        T_ = moved;
        last_ = next;
        damping = std::max(1e-7, 0.1 * damping);
      } else {
        damping *= 10.0;
      }
      if (step.norm() < round.least_step) break;
    }
  }

  void classify() {
    const Pose T_camera_reference = T_.inverse();
    for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
      const auto residual = point_residual(config_.noise, problem_.camera, problem_.points[i], T_camera_reference);
      is_inlier_[i] = residual && residual->value.head<2>().squaredNorm() < kPixelGate &&
                      residual->value.z() * residual->value.z() < kDepthGate;
    }
  }

  // Leaves out the surfaces of image blocks that contradict the pose of the points, as those of somebody who walks do.
  // Within a block they move together, so that their mean shows what is within the noise of each.
  void doubt_surfaces() {
    constexpr double kSigmas2 = 9.0;
    if (problem_.depth == nullptr) return;
    const Term points = linearise(T_, kPoints).points;
    const Matrix6d covariance = scaled_information(points, points.residuals).ldlt().solve(Matrix6d::Identity());
    const std::vector<Block> blocks = blocks_at(T_.inverse());
    for (std::size_t i = 0; i < blocks_of_.size(); ++i) {
      if (blocks_of_[i] == kNoBlock) continue;
      const Block& block = blocks[blocks_of_[i]];
      const Vector6d jacobian = block.jacobian / block.weight;
      const double variance = 1.0 / (config_.surface.weight * block.weight) + jacobian.dot(covariance * jacobian);
      is_doubted_[i] = std::pow(block.distance / block.weight, 2) > kSigmas2 * variance;
    }
  }

  // A gate narrower than the noise would keep only what confirms the initial pose. A gate wider than necessary would
  // accept samples where something else has taken their place.
  void choose_surface_gate() {
    constexpr std::size_t kStride = 4;
    constexpr double kSigmas = 3.0, kPerMedian = 1.4826;  // sigma of a normal distribution by its median error
    if (problem_.depth == nullptr) return;
    const Pose T_camera_reference = T_.inverse();
    std::vector<double> errors;
    for (std::size_t i = 0; i < problem_.surface.size(); i += kStride) {
      const auto residual =
          surface_residual(config_.noise, problem_.camera, *problem_.depth, problem_.surface[i], T_camera_reference);
      if (!residual) continue;
      const double error = std::abs(residual->distance_m) / residual->sigma_m;
      if (error < kSigmas || error * residual->sigma_m < config_.surface.max_distance_m) errors.push_back(error);
    }
    if (errors.empty()) return;
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    surface_gate_ = kSigmas * std::min(1.0, kPerMedian * *middle);
  }

  // Result after the last round.
  Alignment summarise() const;

 private:
  // Sums over the surface samples that an image block sees, weighted by their information.
  struct Block {
    double weight = 0.0, distance = 0.0;
    Vector6d jacobian = Vector6d::Zero();
  };
  static constexpr std::size_t kNoBlock = std::numeric_limits<std::size_t>::max();

  std::vector<Block> blocks_at(const Pose& T_camera_reference) {
    constexpr std::size_t kColumns = 8, kRows = 6;
    std::vector<Block> blocks(kColumns * kRows);
    blocks_of_.assign(problem_.surface.size(), kNoBlock);
    for (std::size_t i = 0; i < problem_.surface.size(); ++i) {
      const SurfaceSample& sample = problem_.surface[i];
      const auto residual =
          surface_residual(config_.noise, problem_.camera, *problem_.depth, sample, T_camera_reference);
      if (!residual || std::abs(residual->distance_m) > config_.surface.max_distance_m) continue;
      const Eigen::Vector2d pixel = problem_.camera.project(T_camera_reference * sample.point);
      const auto cell = [](double at, int size, std::size_t cells) {
        return static_cast<std::size_t>(std::clamp(at / size, 0.0, 0.999) * static_cast<double>(cells));
      };
      blocks_of_[i] =
          cell(pixel.y(), problem_.camera.height, kRows) * kColumns + cell(pixel.x(), problem_.camera.width, kColumns);
      Block& block = blocks[blocks_of_[i]];
      const double weight = 1.0 / (residual->sigma_m * residual->sigma_m);
      block.weight += weight;
      block.distance += weight * residual->distance_m;
      block.jacobian += weight * residual->jacobian;
    }
    return blocks;
  }

  Linearisation linearise(const Pose& T, const Round& round) const {
    Linearisation result;
    const Pose T_camera_reference = T.inverse();
    add_points(T_camera_reference, result.points);
    if (problem_.depth != nullptr && round.stride > 0) add_surface(T_camera_reference, round, result);
    if (problem_.prior) add_prior(T, result.prior);
    return result;
  }

  // To first order: the tangents at the prior and at T are taken as the same, because they are only a step apart.
  void add_prior(const Pose& T, Term& term) const {
    const Vector6d error = geometry::se3_log(problem_.prior->T_reference_camera.inverse() * T);
    term.hessian = problem_.prior->information;
    term.gradient = problem_.prior->information * error;
    term.cost = 0.5 * error.dot(term.gradient);
  }

  void add_points(const Pose& T_camera_reference, Term& term) const {
    for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
      if (!is_inlier_[i]) continue;
      const PointConstraint& point = problem_.points[i];
      const auto residual = point_residual(config_.noise, problem_.camera, point, T_camera_reference);
      if (!residual) continue;
      const double error = residual->value.norm();
      const double weight = huber_weight(error);
      for (int row = 0; row < 3; ++row) {
        term.add(residual->jacobian[static_cast<std::size_t>(row)], residual->value[row], weight);
      }
      term.cost += huber_cost(error);
      term.residuals += point.depth_m > 0.0 ? 3 : 2;
    }
  }

  void add_surface(const Pose& T_camera_reference, const Round& round, Linearisation& result) const {
    Term& term = result.surface;
    const double narrow_m = round.gate_share * config_.surface.max_distance_m;
    const double share = config_.surface.weight * static_cast<double>(round.stride);
    for (std::size_t i = 0; i < problem_.surface.size(); i += round.stride) {
      if (is_doubted_[i]) continue;
      const SurfaceSample& sample = problem_.surface[i];
      const auto residual =
          surface_residual(config_.noise, problem_.camera, *problem_.depth, sample, T_camera_reference);
      if (!residual) continue;
      const double gate_m = std::max(narrow_m, surface_gate_ * residual->sigma_m);
      if (std::abs(residual->distance_m) > gate_m) continue;
      const double per_m = 1.0 / residual->sigma_m;
      const double error = std::abs(residual->distance_m) * per_m;
      const double weight = share * huber_weight(error);
      term.add(residual->jacobian, residual->distance_m, weight * per_m * per_m);
      // The cost is relative to that of the gate, so that dropping a sample never pays.
      term.cost += share * (huber_cost(error) - huber_cost(gate_m * per_m));
      result.surface_squares_m2 += residual->distance_m * residual->distance_m;
      ++term.residuals;
    }
  }

  const SlamConfig& config_;
  const AlignmentProblem& problem_;
  Pose T_;              // of the camera in the reference
  Linearisation last_;  // at T_
  std::vector<bool> is_inlier_;
  std::vector<bool> is_doubted_;        // of the surface samples
  std::vector<std::size_t> blocks_of_;  // the same
  double surface_gate_ = 0.0;           // of a plane distance, in sigmas, where that is wider than the round's gate
};

Alignment Refinement::summarise() const {
  const Pose T_camera_reference = T_.inverse();
  Term points;  // computed again, because the inliers have changed
  add_points(T_camera_reference, points);
  Alignment result;
  // Products of many rotations drift from orthonormality, and inversion by transposition makes it worse.
  result.T_reference_camera = geometry::make_pose(T_.translation(), Eigen::Quaterniond(T_.linear()));
  const double samples = config_.surface.weight * last_.surface.residuals;
  result.surface_information = scaled_information(last_.surface, samples);
  if (samples > 6.0) result.surface_variance = unit_variance(last_.surface, samples);
  result.information = scaled_information(points, points.residuals) + result.surface_information;
  result.is_inlier = is_inlier_;
  result.inliers = static_cast<int>(std::count(is_inlier_.begin(), is_inlier_.end(), true));
  double squares = 0.0;
  for (std::size_t i = 0; i < is_inlier_.size(); ++i) {
    if (!is_inlier_[i]) continue;
    const Eigen::Vector3d p = T_camera_reference * problem_.points[i].p_reference;
    squares += (problem_.camera.project(p) - problem_.points[i].pixel).squaredNorm();
  }
  result.rms_px = result.inliers > 0 ? std::sqrt(squares / result.inliers) : 0.0;
  result.surface_matches = last_.surface.residuals;
  if (result.surface_matches > 0) result.surface_rms_m = std::sqrt(last_.surface_squares_m2 / result.surface_matches);
  return result;
}

}  // namespace

double pixel_error(const geometry::PinholeCamera& camera, const PointConstraint& point,
                   const geometry::Pose& T_camera_reference) {
  const Eigen::Vector3d p = T_camera_reference * point.p_reference;
  return p.z() > 0.0 ? (camera.project(p) - point.pixel).norm() : std::numeric_limits<double>::infinity();
}

std::optional<PointResidual> point_residual(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                            const PointConstraint& point, const Pose& T_camera_reference) {
  const Eigen::Vector3d p = T_camera_reference.linear() * point.p_reference + T_camera_reference.translation();
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
  const Eigen::Vector3d p_sample = T_camera_reference.linear() * sample.point + T_camera_reference.translation();
  if (p_sample.z() < noise.min_depth_m) return std::nullopt;
  const double per_z = 1.0 / p_sample.z();
  const double column = camera.fx * p_sample.x() * per_z + camera.cx + 0.5;
  const double row = camera.fy * p_sample.y() * per_z + camera.cy + 0.5;
  if (!(column >= 0.0 && row >= 0.0 && column < depth.width && row < depth.height)) return std::nullopt;
  const int u = static_cast<int>(column);  // rounding: half a pixel was added
  const int v = static_cast<int>(row);
  const double depth_m = depth(u, v);
  if (!is_depth(noise, depth_m)) return std::nullopt;
  const Eigen::Vector3d p = camera.unproject(u, v, depth_m);
  const Eigen::Vector3d normal = T_camera_reference.linear() * sample.normal;
  SurfaceResidual residual;
  residual.distance_m = normal.dot(p - p_sample);
  // A depth error moves the point along its ray (p / z); the plane distance sees the part along the normal.
  residual.sigma_m = depth_sigma(noise, depth_m) * std::max(0.2, std::abs(normal.dot(p)) / depth_m);
  // Here the frame's point moves and the sample stays: the sign is opposite to that of a point known in the reference.
  residual.jacobian = -by_pose(normal, p);
  return residual;
}

bool has_witnesses(const TrackerConfig& config, std::span<const PointConstraint> points) {
  const auto confirmed =
      std::count_if(points.begin(), points.end(), [](const auto& point) { return point.is_confirmed; });
  return confirmed >= 2 * config.min_inliers;
}

Alignment refine_pose(const SlamConfig& config, const AlignmentProblem& problem, const Pose& T_reference_camera) {
  Refinement refinement(config, problem, T_reference_camera);
  // Points that several key-frames have seen stand still; near surfaces outweigh them, and may be those of somebody who
  // walks in front of the camera.
  std::span<const Round> rounds = kRounds;
  if (refinement.starts_with_points()) {
    refinement.optimise(kPoints);
    refinement.classify();
    refinement.doubt_surfaces();
    rounds = rounds.subspan(1);
  }
  for (const Round& round : rounds) {
    refinement.choose_surface_gate();
    refinement.optimise(round);
    refinement.classify();
  }
  return refinement.summarise();
}

}  // namespace lapis::slam
