#include "slam/core/calibration/focal_length.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "slam/core/frame/noise_model.hpp"

namespace lapis::slam {
namespace {

constexpr std::size_t kFewestPoints = 30;
constexpr std::size_t kFewestKeyframes = 5;
constexpr int kMostSteps = 20;
constexpr double kSettled = 1e-6;
constexpr double kLargestLogRatio = 0.5;
constexpr double kHuber = 2.0;  // [standard deviations]

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;
template <int kRows>
using Jacobian = Eigen::Matrix<double, kRows, 7>;  // by motion (right perturbation) and log ratio

struct Unknowns {
  geometry::Pose T_second_first;
  double log_ratio = 0.0;
};

/// Normal equations, and how well the points fit.
struct System {
  Matrix7d H = Matrix7d::Zero();
  Vector7d b = Vector7d::Zero();
  double squares = 0.0;  // of whitened residuals, with their weights
  int residuals = 0;

  template <int kRows>
  void add(const Eigen::Matrix<double, kRows, 1>& residual, const Jacobian<kRows>& J) {
    const double length = residual.norm();
    const double weight = length <= kHuber ? 1.0 : kHuber / length;
    H += weight * J.transpose() * J;
    b += weight * J.transpose() * residual;
    squares += weight * residual.squaredNorm();
    residuals += kRows;
  }
};

/// A point with its derivatives in the second camera.
struct Moved {
  Eigen::Vector3d ray;       // of the first pixel, z = 1, in the first camera
  Eigen::Vector3d p_second;  // [m]
  Eigen::Matrix<double, 3, 7> J;
};

Moved moved(const geometry::PinholeCamera& camera, const Unknowns& x, const SharedPoint& point) {
  const double shrink = std::exp(-x.log_ratio);
  Moved out;
  out.ray = {(point.first.x() - camera.cx) / camera.fx * shrink, (point.first.y() - camera.cy) / camera.fy * shrink,
             1.0};
  const Eigen::Vector3d p_first = point.first_depth_m * out.ray;
  const Eigen::Matrix3d R = x.T_second_first.linear();
  out.p_second = x.T_second_first * p_first;
  out.J.leftCols<3>() = R;
  out.J.middleCols<3>(3) = -R * geometry::skew(p_first);
  out.J.col(6) = R * Eigen::Vector3d(-p_first.x(), -p_first.y(), 0.0);
  return out;
}

void add_pixel(const NoiseConfig& noise, const geometry::PinholeCamera& camera, const Unknowns& x,
               const SharedPoint& point, const Moved& m, System& system) {
  const double stretch = std::exp(x.log_ratio);
  const Eigen::Vector3d& p = m.p_second;
  const Eigen::Vector2d focal(camera.fx * stretch, camera.fy * stretch);
  const Eigen::Vector2d offset = focal.cwiseProduct(p.head<2>() / p.z());  // from the principal point
  Eigen::Matrix<double, 2, 3> projection;
  projection << focal.x() / p.z(), 0.0, -offset.x() / p.z(), 0.0, focal.y() / p.z(), -offset.y() / p.z();
  Jacobian<2> J = projection * m.J;
  J.col(6) += offset;
  const Eigen::Vector2d residual = offset + Eigen::Vector2d(camera.cx, camera.cy) - point.second;
  const Eigen::Vector2d by_depth = projection * (x.T_second_first.linear() * m.ray);
  const double sigma_m = depth_sigma(noise, point.first_depth_m);
  const double variance = point.first_sigma_px * point.first_sigma_px + point.second_sigma_px * point.second_sigma_px;
  const Eigen::Matrix2d covariance =
      variance * Eigen::Matrix2d::Identity() + sigma_m * sigma_m * by_depth * by_depth.transpose();
  const Eigen::LLT<Eigen::Matrix2d> root(covariance);
  system.add<2>(root.matrixL().solve(residual), root.matrixL().solve(J));
}

void add_depth(const NoiseConfig& noise, const SharedPoint& point, const Moved& m, System& system) {
  if (!is_depth(noise, point.second_depth_m)) return;
  const double sigma_m = std::hypot(depth_sigma(noise, point.first_depth_m), depth_sigma(noise, point.second_depth_m));
  const Eigen::Matrix<double, 1, 1> residual((m.p_second.z() - point.second_depth_m) / sigma_m);
  system.add<1>(residual, m.J.row(2) / sigma_m);
}

System linearise(const NoiseConfig& noise, const geometry::PinholeCamera& camera, const Unknowns& x,
                 const std::vector<SharedPoint>& points) {
  System system;
  for (const SharedPoint& point : points) {
    const Moved m = moved(camera, x, point);
    if (!is_depth(noise, point.first_depth_m) || m.p_second.z() < noise.min_depth_m) continue;
    add_pixel(noise, camera, x, point, m, system);
    add_depth(noise, point, m, system);
  }
  return system;
}

/// Information of the log ratio when the motion is unknown, reduced where the points fit worse than their noise says.
double information_of(const System& system) {
  const geometry::Matrix6d motion = system.H.topLeftCorner<6, 6>();
  const geometry::Vector6d mixed = system.H.topRightCorner<6, 1>();
  const double left = system.H(6, 6) - mixed.dot(motion.ldlt().solve(mixed));
  const double fit = system.squares / std::max(system.residuals - 7, 1);
  return left / std::max(fit, 1.0);
}

bool differs(const FocalLengthWatch::Estimate& estimate, double least, double sigmas) {
  const double size = std::abs(std::log(estimate.ratio));
  return size > least && size > sigmas * estimate.sigma;
}

/// The points that two key-frames share, by the landmarks of the second.
std::vector<SharedPoint> shared_points(const Map& map, KeyframeId first, KeyframeId second, const NoiseConfig& noise,
                                       double scale_factor) {
  const Keyframe &a = map.keyframe(first), &b = map.keyframe(second);
  const auto sigma_px = [&](const Feature& f) { return noise.pixel_sigma_px * std::pow(scale_factor, f.octave); };
  std::vector<SharedPoint> points;
  for (std::size_t i = 0; i < b.landmarks.size(); ++i) {
    if (b.landmarks[i] == kNoLandmark) continue;
    for (const Observation& seen : map.landmark(b.landmarks[i]).observations) {
      if (seen.keyframe != first) continue;
      const Feature &f = a.features[static_cast<std::size_t>(seen.feature)], &g = b.features[i];
      if (is_depth(noise, f.depth_m))
        points.push_back({f.pixel, f.depth_m, sigma_px(f), g.pixel, g.depth_m, sigma_px(g)});
    }
  }
  return points;
}

}  // namespace

std::optional<FocalEvidence> measure_focal_length(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                                  const geometry::Pose& T_second_first,
                                                  const std::vector<SharedPoint>& points) {
  if (points.size() < kFewestPoints) return std::nullopt;
  Unknowns x{T_second_first};
  for (int step = 0; step < kMostSteps; ++step) {
    const System system = linearise(noise, camera, x, points);
    const Vector7d change = system.H.ldlt().solve(-system.b);
    if (!change.allFinite()) return std::nullopt;
    x.T_second_first = x.T_second_first * geometry::se3_exp(change.head<6>());
    x.log_ratio += change[6];
    if (std::abs(x.log_ratio) > kLargestLogRatio) return std::nullopt;
    if (change.norm() > kSettled) continue;
    const double information = information_of(system);
    if (!(information > 0.0)) return std::nullopt;
    return FocalEvidence{x.log_ratio, information};
  }
  return std::nullopt;
}

void FocalLengthWatch::add(const Map& map, KeyframeId id) {
  constexpr std::size_t kPartners = 5;
  std::optional<FocalEvidence> best;  // partners see the same corners of the new key-frame, so they are not added up
  for (const KeyframeId other : map.covisible(id, kPartners)) {
    const geometry::Pose T_second_first = map.keyframe(id).T_map_camera.inverse() * map.keyframe(other).T_map_camera;
    const auto evidence = measure_focal_length(noise_, map.keyframe(id).camera, T_second_first,
                                               shared_points(map, other, id, noise_, scale_factor_));
    if (evidence && (!best || evidence->information > best->information)) best = evidence;
  }
  if (best) evidence_.push_back(*best);
}

std::optional<FocalLengthWatch::Estimate> FocalLengthWatch::estimate() const {
  if (evidence_.size() < kFewestKeyframes) return std::nullopt;
  double weights = 0.0, sum = 0.0, scatter = 0.0;
  for (const auto& e : evidence_) {
    weights += e.information;
    sum += e.information * e.log_ratio;
  }
  const double mean = sum / weights;
  for (const auto& e : evidence_) scatter += std::pow(e.information * (e.log_ratio - mean), 2);
  return Estimate{std::exp(mean), std::max(std::sqrt(scatter) / weights, 1.0 / std::sqrt(weights)), evidence_.size()};
}

std::optional<FocalLengthWatch::Estimate> FocalLengthWatch::contradiction() const {
  // Student's distribution of the scatter of 5, 6, ... key-frames: all are exceeded by chance as often as 5 by ten.
  constexpr std::array<double, 6> kSigmas{9.3, 7.3, 6.3, 5.7, 5.3, 5.0};
  constexpr double kMatters = 0.01;
  const auto found = estimate();
  if (!found) return std::nullopt;
  const double sigmas = kSigmas[std::min(found->keyframes - kFewestKeyframes, kSigmas.size() - 1)];
  return differs(*found, kMatters, sigmas) ? found : std::nullopt;
}

std::optional<FocalLengthWatch::Estimate> FocalLengthWatch::refinement() const {
  constexpr double kSigmas = 2.8;  // 95 % of five key-frames
  constexpr double kMatters = 0.002;
  const auto found = estimate();
  return found && differs(*found, kMatters, kSigmas) ? found : std::nullopt;
}

}  // namespace lapis::slam
