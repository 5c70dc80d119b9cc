#include "slam/core/tracking/surface_tracker.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;
using geometry::Vector6d;

constexpr std::size_t kNewest = 5;  // newest key-frames that are considered, besides those that share landmarks
constexpr double kMostAway_m = 2.0, kMostTurned_rad = 0.9;
constexpr double kKeyframeSigma_m = 0.003, kKeyframeSigma_rad = 0.002;  // of the relative pose of near key-frames
// A view contradicts the map when it sees through more than kMostSeenThrough of what should be in view, by more than
// kMargin_m, and sees less than kLittleSeen of it. Surfaces from kLevelCosine on are floors and ceilings.
constexpr double kMostSeenThrough = 0.25, kLittleSeen = 0.3, kMargin_m = 0.3, kLevelCosine = 0.9;
constexpr double kMetresPerRadian = 1.5;  // weight of rotation in the distance of key-frames

/// Directions of the tangent that the measurements determine, and their information. Coordinates a in these directions
/// stand for the step basis * a; the coordinates of a step are dual * step.
struct KnownDirections {
  Eigen::Matrix<double, 6, Eigen::Dynamic> basis;
  Eigen::Matrix<double, Eigen::Dynamic, 6> dual;
  Eigen::VectorXd information;
};

/// Eigenvalues of the Hessian with rotations in units of `lever_m`, relative to that of samples whose normals all have
/// the direction: this is the mean squared cosine. Below `least_share` a direction is left open [after Zhang, Kaess,
/// Singh, ICRA 2016], because noise of the normals alone gives some information.
KnownDirections known_directions(const Matrix6d& information, double lever_m, double least_share) {
  Vector6d units;
  units << 1, 1, 1, 1 / lever_m, 1 / lever_m, 1 / lever_m;
  const Matrix6d scaled = units.asDiagonal() * information * units.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(scaled);
  const double per_sample = scaled.topLeftCorner<3, 3>().trace();  // squared cosines with three axes add up to one
  KnownDirections known;
  std::vector<int> kept;
  for (int i = 0; i < 6; ++i) {
    if (solver.eigenvalues()[i] > 0.0 && solver.eigenvalues()[i] >= least_share * per_sample) kept.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(kept.size());
  known.basis.resize(6, count);
  known.dual.resize(count, 6);
  known.information.resize(count);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const Vector6d direction = solver.eigenvectors().col(kept[k]);
    known.basis.col(column) = units.cwiseProduct(direction);
    known.dual.row(column) = direction.cwiseQuotient(units);
    known.information[column] = solver.eigenvalues()[kept[k]];
  }
  return known;
}

double mean_depth_m(std::span<const SurfaceSample> samples) {
  double sum = 0.0;
  for (const SurfaceSample& sample : samples) sum += sample.point.norm();
  return samples.empty() ? 1.0 : sum / static_cast<double>(samples.size());
}

}  // namespace

std::vector<KeyframeId> SurfaceTracker::near_keyframes(const Map& map, KeyframeId reference,
                                                       const Pose& T_map_camera) const {
  std::vector<KeyframeId> ids = map.covisible(reference, static_cast<std::size_t>(config_.tracker.local_keyframes));
  ids.push_back(reference);
  const std::size_t count = map.keyframes().size();
  for (std::size_t back = 1; back <= std::min(kNewest, count); ++back) ids.push_back(count - back);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  std::vector<Candidate> near;
  for (const KeyframeId id : ids) {
    if (map.keyframe(id).sub_map != map.keyframe(reference).sub_map) continue;
    const Pose T = map.keyframe(id).T_map_camera.inverse() * T_map_camera;
    const double away_m = T.translation().norm(), turned_rad = geometry::rotation_angle(T.linear());
    if (away_m > kMostAway_m || turned_rad > kMostTurned_rad) continue;
    near.push_back({id, away_m + kMetresPerRadian * turned_rad});
  }
  std::sort(near.begin(), near.end(), [](const Candidate& a, const Candidate& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.id > b.id;
  });
  near.resize(std::min(near.size(), static_cast<std::size_t>(config_.surface.near_keyframes)));
  std::vector<KeyframeId> out;
  for (const Candidate& candidate : near) out.push_back(candidate.id);
  return out;
}

SurfaceTracker::Sight SurfaceTracker::look(const AlignmentProblem& problem, const Pose& T_reference_camera,
                                           const Matrix6d& covariance) const {
  const double sigma_m = largest_sigma(covariance, 0), sigma_rad = largest_sigma(covariance, 3);
  const Pose T_camera_reference = T_reference_camera.inverse();
  Sight sight;
  for (const SurfaceSample& sample : problem.surface) {
    const auto residual = surface_residual(config_.noise, problem.camera, *problem.depth, sample, T_camera_reference);
    if (!residual) continue;
    const double margin_m = kMargin_m + 3.0 * (sigma_m + sigma_rad * sample.point.norm() + residual->sigma_m);
    if (std::abs(residual->distance_m) < std::max(3.0 * residual->sigma_m, 0.02)) {
      ++sight.seen;
    } else if (residual->distance_m < -margin_m) {
      ++sight.seen_through;
    } else {
      ++sight.differs;
    }
  }
  return sight;
}

bool SurfaceTracker::is_contradicted(const AlignmentProblem& problem, const Pose& T_reference_camera,
                                     const Matrix6d& covariance, const Eigen::Vector3d& up_reference) const {
  std::vector<SurfaceSample> upright;
  for (const SurfaceSample& sample : problem.surface) {
    if (std::abs(sample.normal.dot(up_reference)) < kLevelCosine) upright.push_back(sample);
  }
  AlignmentProblem walls = problem;
  walls.surface = upright;
  const Sight sight = look(walls, T_reference_camera, covariance);
  return 2 * sight.in_view() >= config_.surface.min_matches &&
         sight.seen_through > kMostSeenThrough * sight.in_view() && sight.seen < kLittleSeen * sight.in_view();
}

TrackOutcome SurfaceTracker::track(const Map& map, const Frame& frame, KeyframeId reference,
                                   const MotionModel::Expected& expected) const {
  TrackOutcome outcome;
  outcome.reason = "surfaces are not used";
  if (!config_.surface.enabled) return outcome;
  outcome.reason = "no key-frame has seen these surfaces";
  const std::vector<KeyframeId> near = near_keyframes(map, reference, expected.T_map_camera);
  if (near.empty()) {
    outcome.is_new_view = true;
    return outcome;
  }
  outcome.reference = near.front();
  const Pose T_reference_map = map.keyframe(outcome.reference).T_map_camera.inverse();
  std::vector<SurfaceSample> surface;
  for (const KeyframeId id : near) {
    const Pose T_reference_other = T_reference_map * map.keyframe(id).T_map_camera;
    for (const SurfaceSample& sample : map.keyframe(id).surface) {
      surface.push_back({T_reference_other * sample.point, T_reference_other.linear() * sample.normal});
    }
  }
  const Pose T_expected = T_reference_map * expected.T_map_camera;
  const Matrix6d prior = expected.covariance.inverse();
  const AlignmentProblem problem{frame.input->camera, {}, surface, &frame.input->depth, PosePrior{T_expected, prior}};
  Alignment alignment = refine_pose(config_, problem, T_expected);
  const auto& surfaces = config_.surface;
  const bool is_valid = geometry::is_valid(alignment.T_reference_camera);
  const Sight sight = look(problem, is_valid ? alignment.T_reference_camera : T_expected, expected.covariance);
  if (!is_valid || alignment.surface_matches < surfaces.min_matches ||
      sight.seen < surfaces.min_share * sight.in_view()) {
    outcome.reason = "too little of the near surfaces is seen again";
    outcome.is_new_view = true;
    const Eigen::Vector3d up_reference = T_reference_map.linear() * Eigen::Vector3d::UnitZ();
    outcome.is_contradicted = is_contradicted(problem, T_expected, expected.covariance, up_reference);
    return outcome;
  }
  const KnownDirections known =
      known_directions(alignment.surface_information, mean_depth_m(surface), surfaces.least_cosine2);
  if (known.information.size() == 0) {
    outcome.reason = "the surfaces tell no direction";
    return outcome;
  }
  // At the optimum the pull of the prior equals that of the surfaces; this step leads to where the surfaces alone
  // would.
  const Vector6d pulled = geometry::se3_log(T_expected.inverse() * alignment.T_reference_camera);
  const Eigen::VectorXd pull = known.basis.transpose() * (prior * pulled) / alignment.surface_variance;
  const Vector6d onwards = known.basis * pull.cwiseQuotient(known.information);
  const Pose T_surfaces = alignment.T_reference_camera * geometry::se3_exp(onwards);
  const Vector6d difference = geometry::se3_log(T_expected.inverse() * T_surfaces);
  const Eigen::VectorXd error = known.dual * difference;
  Eigen::MatrixXd covariance = known.dual * expected.covariance * known.dual.transpose();
  Vector6d between_keyframes;  // not in motion's covariance: the samples come from several key-frames
  between_keyframes << Eigen::Vector3d::Constant(kKeyframeSigma_m * kKeyframeSigma_m),
      Eigen::Vector3d::Constant(kKeyframeSigma_rad * kKeyframeSigma_rad);
  covariance += known.dual * between_keyframes.asDiagonal() * known.dual.transpose();
  covariance.diagonal() += known.information.cwiseInverse();
  const double sigmas = std::sqrt(error.dot(covariance.ldlt().solve(error)) / static_cast<double>(error.size()));
  if (!(sigmas <= surfaces.max_disagreement)) {
    outcome.reason = "surfaces and motion contradict each other";
    return outcome;
  }
  alignment.T_reference_camera = T_surfaces;
  alignment.information = known.dual.transpose() * known.information.asDiagonal() * known.dual;
  alignment.surface_information = alignment.information;
  outcome.alignment = alignment;
  outcome.is_tracked = geometry::is_valid(T_surfaces);
  outcome.reason = outcome.is_tracked ? "" : "the pose is not finite";
  return outcome;
}

}  // namespace lapis::slam
