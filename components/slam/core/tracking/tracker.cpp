#include "slam/core/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "slam/core/tracking/pose_solver.hpp"
#include "slam/core/tracking/support.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

std::string shortage(int found, int needed, const char* what) {
  return std::to_string(found) + " " + what + ", " + std::to_string(needed) + " needed";
}

std::string doubt(const Support& support) {
  std::string text = "only " + std::to_string(support.agree) + " of " + std::to_string(support.of) + " matches agree";
  if (support.rivals > support.by_chance) text += ", and " + std::to_string(support.rivals) + " with another pose";
  return text;
}

}  // namespace

void Tracker::set_reference(const Map& map, KeyframeId reference) { local_ = local_map(map, reference); }

std::vector<KeyframeId> Tracker::nearby(const Map& map, KeyframeId reference) const {
  std::vector<KeyframeId> all = map.covisible(reference, static_cast<std::size_t>(config_.tracker.local_keyframes - 1));
  all.insert(all.begin(), reference);
  return all;
}

Tracker::LocalMap Tracker::local_map(const Map& map, KeyframeId reference) const {
  std::vector<KeyframeId> all = nearby(map, reference);
  LocalMap local{reference, map.landmarks_of(all), {}};
  if (!config_.surface.enabled) return local;
  const Pose T_reference_map = map.keyframe(reference).T_map_camera.inverse();
  all.resize(std::min(all.size(), static_cast<std::size_t>(config_.surface.keyframes)));
  for (const KeyframeId id : all) {
    const Pose T_reference_other = T_reference_map * map.keyframe(id).T_map_camera;
    for (const SurfaceSample& sample : map.keyframe(id).surface) {
      local.surface.push_back({T_reference_other * sample.point, T_reference_other.linear() * sample.normal});
    }
  }
  return local;
}

TrackOutcome Tracker::track(const Map& map, const Frame& frame, const std::optional<Pose>& predicted, double radius_px,
                            const std::function<bool(const TrackOutcome&)>& is_expected) const {
  TrackOutcome best;
  const int features = static_cast<int>(frame.features.size());
  best.reason = shortage(features, config_.tracker.min_inliers, "features");
  if (features < config_.tracker.min_inliers) return best;
  best.reason = "nothing tells where the camera may be";
  if (!predicted) return best;
  const auto merit = [](const TrackOutcome& outcome, bool expected) {
    return std::tuple(outcome.is_tracked && expected, outcome.is_tracked, outcome.inliers.size());
  };
  bool is_best_expected = false;
  const auto is_convincing = [&](TrackOutcome outcome) {
    const bool expected = outcome.is_tracked && is_expected(outcome);
    if (merit(outcome, expected) >= merit(best, is_best_expected)) {
      best = std::move(outcome);
      is_best_expected = expected;
    }
    return is_best_expected && best.inliers.size() >= static_cast<std::size_t>(config_.tracker.min_matches);
  };
  if (is_convincing(track_projected(map, frame, local_, *predicted, radius_px))) return best;
  for (const double wider_px : {config_.matcher.search_radius_px, config_.matcher.wide_search_radius_px}) {
    if (wider_px <= radius_px) continue;
    if (is_convincing(track_projected(map, frame, local_, *predicted, wider_px))) return best;
  }
  is_convincing(track_brute_force(map, frame, local_.reference, [this] { return local_; }));
  return best;
}

double Tracker::surprise_px(const Map& map, const Frame& frame, const TrackOutcome& outcome,
                            const Pose& T_map_camera) const {
  const Pose T_camera_map = T_map_camera.inverse();
  double squares = 0.0;
  for (const Match& match : outcome.inliers) {
    const Feature& feature = frame.features[static_cast<std::size_t>(match.feature)];
    const Eigen::Vector3d p = T_camera_map * map.landmark(match.landmark).p_map;
    if (p.z() < config_.noise.min_depth_m) return std::numeric_limits<double>::infinity();
    const double error_px = (frame.input->camera.project(p) - feature.pixel).norm();
    squares += std::pow(error_px / std::pow(config_.features.scale_factor, feature.octave), 2);
  }
  return std::sqrt(squares / static_cast<double>(outcome.inliers.size()));
}

TrackOutcome Tracker::recognize(const Map& map, const Frame& frame, KeyframeId keyframe,
                                const std::optional<Pose>& T_map_camera) const {
  const auto landmarks = [&] { return LocalMap{keyframe, map.landmarks_of(nearby(map, keyframe)), {}}; };
  if (!T_map_camera) return track_brute_force(map, frame, keyframe, landmarks);
  return track_projected(map, frame, landmarks(), *T_map_camera, config_.matcher.wide_search_radius_px);
}

TrackOutcome Tracker::track_projected(const Map& map, const Frame& frame, const LocalMap& local, const Pose& predicted,
                                      double radius_px) const {
  TrackOutcome outcome;
  outcome.reference = local.reference;
  const auto matches = match_by_projection(config_, map, local.landmarks, frame, predicted, radius_px);
  outcome.matches = static_cast<int>(matches.size());
  outcome.reason = shortage(outcome.matches, config_.tracker.min_inliers, "matches");
  if (outcome.matches < config_.tracker.min_inliers) return outcome;
  const auto points = constraints(map, frame, local.reference, matches);
  const AlignmentProblem problem{frame.input->camera, points, local.surface, &frame.input->depth};
  outcome.alignment = refine_pose(config_, problem, map.keyframe(local.reference).T_map_camera.inverse() * predicted);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (outcome.alignment.is_inlier[i]) outcome.inliers.push_back(matches[i]);
  }
  outcome.reason = fault_of(outcome.alignment, frame.input->camera, points, 4.0 * radius_px * radius_px);
  outcome.is_tracked = outcome.reason.empty();
  return outcome;
}

TrackOutcome Tracker::track_brute_force(const Map& map, const Frame& frame, KeyframeId keyframe,
                                        const std::function<LocalMap()>& gather) const {
  TrackOutcome outcome;
  const Keyframe& reference = map.keyframe(keyframe);
  const geometry::PinholeCamera& camera = frame.input->camera;
  const auto matches = match_brute_force(config_.matcher, reference, frame);
  outcome.matches = static_cast<int>(matches.size());
  outcome.reason = shortage(outcome.matches, config_.tracker.min_inliers, "matches");
  if (outcome.matches < config_.tracker.min_inliers) return outcome;
  const auto points = constraints(map, frame, keyframe, matches);
  const auto solved = solve_pose(config_.tracker, camera, witnesses(config_.tracker, points));
  outcome.reason = "no pose explains " + std::to_string(config_.tracker.min_inliers) + " matches";
  if (!solved) return outcome;
  // The pose is good enough to find the rest of the local map by projection. These matches were sought near it; the
  // first ones were not.
  outcome = track_projected(map, frame, gather(), reference.T_map_camera * solved->T_reference_camera,
                            config_.matcher.search_radius_px);
  if (!outcome.is_tracked) return outcome;
  outcome.reason = fault_of(outcome.alignment, camera, points, static_cast<double>(camera.width) * camera.height);
  outcome.is_tracked = outcome.reason.empty();
  return outcome;
}

std::vector<PointConstraint> Tracker::constraints(const Map& map, const Frame& frame, KeyframeId reference,
                                                  const std::vector<Match>& matches) const {
  const Pose T_reference_map = map.keyframe(reference).T_map_camera.inverse();
  std::vector<PointConstraint> points;
  points.reserve(matches.size());
  for (const Match& match : matches) {
    const Feature& feature = frame.features[static_cast<std::size_t>(match.feature)];
    const Landmark& landmark = map.landmark(match.landmark);
    const double sigma = config_.noise.pixel_sigma_px * std::pow(config_.features.scale_factor, feature.octave);
    points.push_back(
        {T_reference_map * landmark.p_map, feature.pixel, feature.depth_m, sigma, landmark.observations.size() > 1});
  }
  return points;
}

// Why the pose is not believed: it has too few inliers, or not more of the points than any other pose, or chance.
std::string Tracker::fault_of(const Alignment& alignment, const geometry::PinholeCamera& camera,
                              const std::vector<PointConstraint>& points, double window_px2) const {
  const TrackerConfig& config = config_.tracker;
  if (!geometry::is_valid(alignment.T_reference_camera)) return "the pose is not finite";
  if (alignment.inliers < config.min_inliers) return shortage(alignment.inliers, config.min_inliers, "inliers");
  const Support support = find_support(config, camera, points, alignment.T_reference_camera, window_px2);
  return is_significant(config, support) ? "" : doubt(support);
}

}  // namespace lapis::slam
