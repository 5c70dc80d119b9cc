#include "slam/core/tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slam/core/tracking/pose_solver.hpp"

namespace lapis::slam {
namespace {

using geometry::Pose;

std::string shortage(int found, int needed, const char* what) {
  return std::to_string(found) + " " + what + ", " + std::to_string(needed) + " needed";
}

}  // namespace

void Tracker::set_reference(const Map& map, KeyframeId reference) { local_ = local_map(map, reference); }

Tracker::LocalMap Tracker::local_map(const Map& map, KeyframeId reference) const {
  std::vector<KeyframeId> nearby =
      map.covisible(reference, static_cast<std::size_t>(config_.tracker.local_keyframes - 1));
  nearby.insert(nearby.begin(), reference);
  LocalMap local{reference, map.landmarks_of(nearby), {}};
  if (!config_.surface.enabled) return local;
  const Pose T_reference_map = map.keyframe(reference).T_map_camera.inverse();
  nearby.resize(std::min(nearby.size(), static_cast<std::size_t>(config_.surface.keyframes)));
  for (const KeyframeId id : nearby) {
    const Pose T_reference_other = T_reference_map * map.keyframe(id).T_map_camera;
    for (const SurfaceSample& sample : map.keyframe(id).surface) {
      local.surface.push_back({T_reference_other * sample.point, T_reference_other.linear() * sample.normal});
    }
  }
  return local;
}

TrackOutcome Tracker::track(const Map& map, const Frame& frame, const std::optional<Pose>& predicted) const {
  TrackOutcome best;
  const int features = static_cast<int>(frame.features.size());
  best.reason = shortage(features, config_.tracker.min_inliers, "features");
  if (features < config_.tracker.min_inliers) return best;
  const auto is_convincing = [&](TrackOutcome outcome) {
    const bool better = outcome.is_tracked ? !best.is_tracked || outcome.inliers.size() > best.inliers.size()
                                           : !best.is_tracked && outcome.inliers.size() >= best.inliers.size();
    if (better) best = std::move(outcome);
    return best.is_tracked && best.inliers.size() >= static_cast<std::size_t>(config_.tracker.min_matches);
  };
  if (predicted) {
    if (is_convincing(track_projected(map, frame, local_, *predicted, config_.matcher.search_radius_px))) return best;
    if (is_convincing(track_projected(map, frame, local_, *predicted, config_.matcher.wide_search_radius_px)))
      return best;
  }
  if (is_convincing(track_brute_force(map, frame, local_)) || best.is_tracked) return best;
  const auto count = std::min(map.keyframes().size(), static_cast<std::size_t>(config_.tracker.recovery_keyframes));
  for (std::size_t back = 1; back <= count; ++back) {
    const KeyframeId id = map.keyframes().size() - back;
    if (id == local_.reference) continue;
    if (is_convincing(track_brute_force(map, frame, local_map(map, id)))) break;
  }
  return best;
}

TrackOutcome Tracker::recognize(const Map& map, const Frame& frame, KeyframeId keyframe,
                                const std::optional<Pose>& T_map_camera) const {
  LocalMap local = local_map(map, keyframe);
  local.surface.clear();
  if (!T_map_camera) return track_brute_force(map, frame, local);
  return track_projected(map, frame, local, *T_map_camera, config_.matcher.wide_search_radius_px);
}

TrackOutcome Tracker::track_projected(const Map& map, const Frame& frame, const LocalMap& local, const Pose& predicted,
                                      double radius_px) const {
  const auto matches = match_by_projection(config_, map, local.landmarks, frame, predicted, radius_px);
  return align(map, frame, local, matches, map.keyframe(local.reference).T_map_camera.inverse() * predicted);
}

TrackOutcome Tracker::track_brute_force(const Map& map, const Frame& frame, const LocalMap& local) const {
  TrackOutcome outcome;
  const Keyframe& reference = map.keyframe(local.reference);
  const auto matches = match_brute_force(config_.matcher, reference, frame);
  outcome.matches = static_cast<int>(matches.size());
  outcome.reason = shortage(outcome.matches, config_.tracker.min_inliers, "matches");
  if (outcome.matches < config_.tracker.min_inliers) return outcome;
  const Pose T_reference_map = reference.T_map_camera.inverse();
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  for (const Match& match : matches) {
    points.push_back(T_reference_map * map.landmark(match.landmark).p_map);
    pixels.push_back(frame.features[static_cast<std::size_t>(match.feature)].pixel);
  }
  const auto T_reference_camera = solve_pose(config_.tracker, frame.input->camera, points, pixels);
  outcome.reason = "no pose explains " + std::to_string(config_.tracker.min_inliers) + " matches";
  if (!T_reference_camera) return outcome;
  // The pose is good enough to find the rest of the local map by projection.
  const auto more = match_by_projection(config_, map, local.landmarks, frame,
                                        reference.T_map_camera * *T_reference_camera, config_.matcher.search_radius_px);
  return align(map, frame, local, more, *T_reference_camera);
}

TrackOutcome Tracker::align(const Map& map, const Frame& frame, const LocalMap& local,
                            const std::vector<Match>& matches, const Pose& T_reference_camera) const {
  TrackOutcome outcome;
  outcome.reference = local.reference;
  outcome.matches = static_cast<int>(matches.size());
  outcome.reason = shortage(outcome.matches, config_.tracker.min_inliers, "matches");
  if (outcome.matches < config_.tracker.min_inliers) return outcome;
  const Pose T_reference_map = map.keyframe(local.reference).T_map_camera.inverse();
  std::vector<PointConstraint> points;
  points.reserve(matches.size());
  for (const Match& match : matches) {
    const Feature& feature = frame.features[static_cast<std::size_t>(match.feature)];
    const double sigma = config_.noise.pixel_sigma_px * std::pow(config_.features.scale_factor, feature.octave);
    points.push_back({T_reference_map * map.landmark(match.landmark).p_map, feature.pixel, feature.depth_m, sigma});
  }
  const AlignmentProblem problem{frame.input->camera, points, local.surface, &frame.input->depth};
  outcome.alignment = refine_pose(config_, problem, T_reference_camera);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (outcome.alignment.is_inlier[i]) outcome.inliers.push_back(matches[i]);
  }
  if (outcome.alignment.inliers < config_.tracker.min_inliers) {
    outcome.reason = shortage(outcome.alignment.inliers, config_.tracker.min_inliers, "inliers");
  } else if (outcome.alignment.inliers < config_.tracker.min_inlier_share * outcome.matches) {
    outcome.reason = "only " + std::to_string(outcome.alignment.inliers) + " of " + std::to_string(outcome.matches) +
                     " matches agree";
  } else {
    outcome.is_tracked = geometry::is_valid(outcome.alignment.T_reference_camera);
    outcome.reason = outcome.is_tracked ? "" : "the pose is not finite";
  }
  return outcome;
}

}  // namespace lapis::slam
