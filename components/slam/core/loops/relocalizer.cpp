#include "slam/core/loops/relocalizer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {

using geometry::Matrix6d;
using geometry::Pose;

TrackOutcome Relocalizer::search(const Map& map, KeyframeId sub_map, const LoopDetector& places, const Tracker& tracker,
                                 const Frame& frame) const {
  constexpr double kAsGood = 0.7;
  constexpr Reach kSame{1.0, 0.5};
  const auto pose = [&](const TrackOutcome& outcome) {
    return Pose(map.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera);
  };
  std::vector<TrackOutcome> found;
  const auto is_here = [&](KeyframeId id) { return map.keyframe(id).sub_map == sub_map; };
  for (const KeyframeId id : places.resembling(frame, is_here)) {
    TrackOutcome outcome = tracker.recognize(map, frame, id);
    if (outcome.is_tracked && outcome.alignment.inliers >= config_.min_inliers) found.push_back(std::move(outcome));
  }
  TrackOutcome best;
  best.reason = "no place of the map is recognised";
  if (found.empty()) return best;
  best = *std::max_element(found.begin(), found.end(), [](const TrackOutcome& a, const TrackOutcome& b) {
    return a.alignment.inliers < b.alignment.inliers;
  });
  const bool is_ambiguous = std::any_of(found.begin(), found.end(), [&](const TrackOutcome& other) {
    return other.alignment.inliers >= kAsGood * best.alignment.inliers && !is_near(pose(best), pose(other), kSame);
  });
  if (!is_ambiguous) return best;
  best.is_tracked = false;
  best.reason = "several places of the map look like this";
  return best;
}

bool Relocalizer::believes(const Situation& now, const TrackOutcome& outcome) {
  const Pose T_map_camera = now.map.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera;
  bool is_believed = motion_leads_to(now, outcome);
  if (!is_believed) {
    if (!is_certain(outcome)) return false;
    const auto last = now.motion.last_stamp();
    // After a gap, odometry does not tell how the robot has moved since its last pose.
    const bool has_odometry = last ? now.motion.odometry_between(*last, now.stamp()).has_value()
                                   : now.motion.odometry_at(now.stamp()).has_value();
    if (!has_odometry && sees_through_walls(now, outcome)) return false;
    const bool is_contradicted = last && has_odometry;
    if (!is_contradicted || may_be_slip(now, T_map_camera)) {
      is_believed = is_found_again(now, T_map_camera) || is_within_reach(now, T_map_camera);
    } else {
      is_believed = is_within_reach(now, T_map_camera) || weigh(now, T_map_camera, outcome);
    }
  }
  if (is_believed) {
    found_.reset();
    elsewhere_.reset();
  }
  return is_believed;
}

bool Relocalizer::is_found_again(const Situation& now, const Pose& T_map_camera) {
  const int again = found_ && confirms(now, T_map_camera) ? found_->again + 1 : 0;
  found_ = Found{now.stamp(), T_map_camera, again};
  return again >= config_.confirmations;
}

bool Relocalizer::weigh(const Situation& now, const Pose& T_map_camera, const TrackOutcome& outcome) {
  constexpr int kMostAgainst = 3;
  constexpr double kEnoughTurned_rad = 2.0;
  std::vector<LandmarkId> shown;
  for (const Match& match : outcome.inliers) shown.push_back(match.landmark);
  std::sort(shown.begin(), shown.end());
  const auto begin = [&] {
    elsewhere_ = Elsewhere{now.stamp(), outcome.reference, outcome.alignment.T_reference_camera, 0.0, 0.0, shown, 1, 0};
    ++doubted_;
    return false;
  };
  const auto moved = elsewhere_ ? now.motion.odometry_between(elsewhere_->stamp, now.stamp()) : std::nullopt;
  if (!moved) return begin();
  Elsewhere& place = *elsewhere_;
  const Pose T_map_before = now.map.keyframe(place.reference).T_map_camera * place.T_reference_camera;
  if (!is_near(T_map_before * moved->T_from_to, T_map_camera, reach(moved->covariance))) {
    return ++place.against >= kMostAgainst && begin();
  }
  place.against = 0;
  place.stamp = now.stamp();
  place.reference = outcome.reference;
  place.T_reference_camera = outcome.alignment.T_reference_camera;
  place.path_m += moved->path_m;
  place.turned_rad += moved->turned_rad;
  std::vector<LandmarkId> common, all;
  std::set_intersection(shown.begin(), shown.end(), place.landmarks.begin(), place.landmarks.end(),
                        std::back_inserter(common));
  if (common.empty()) {
    ++place.views;
    std::set_union(shown.begin(), shown.end(), place.landmarks.begin(), place.landmarks.end(), std::back_inserter(all));
    place.landmarks = std::move(all);
  }
  const bool has_turned = now.is_odometry_refuted && place.turned_rad >= kEnoughTurned_rad;
  return place.views >= config_.evidence_views && (place.path_m >= config_.evidence_m || has_turned);
}

std::optional<MotionModel::Expected> Relocalizer::expected(const Situation& now, KeyframeId reference) const {
  const auto reckoned = now.motion.dead_reckon(now.stamp());
  if (!reckoned) return now.motion.expect(now.map, now.stamp());
  const Matrix6d between = now.graph.relative_covariance(now.map, reference, reckoned->reference);
  return MotionModel::Expected{now.map.keyframe(reckoned->reference).T_map_camera * reckoned->T_reference_camera,
                               compound_covariance(between, reckoned->T_reference_camera, reckoned->covariance)};
}

// Without odometry the camera may have gained speed since its last pose; and stamps jitter, most where a clock was set.
bool Relocalizer::motion_leads_to(const Situation& now, const TrackOutcome& outcome) const {
  constexpr double kLeastElapsed_s = 0.05;
  const auto lead = expected(now, outcome.reference);
  if (!lead) return false;
  const Pose T_map_camera = now.map.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera;
  Reach within = reach(lead->covariance);
  if (!now.motion.dead_reckon(now.stamp())) {
    const double elapsed_s = std::max(kLeastElapsed_s, (now.stamp() - *now.motion.last_stamp()).seconds());
    const double times = elapsed_s * config_.speed_m_s / config_.near_m;
    within.m += (times - 1.0) * config_.near_m;
    within.rad += (times - 1.0) * config_.near_rad;
  }
  return is_near(lead->T_map_camera, T_map_camera, within);
}

bool Relocalizer::is_within_reach(const Situation& now, const Pose& T_map_camera) const {
  const auto last = now.motion.last_pose(now.map);
  if (!last || now.motion.expect(now.map, now.stamp())) return false;
  const double elapsed_s = (now.stamp() - last->first).seconds();
  return elapsed_s >= 0.0 && elapsed_s <= config_.patience_s && is_near(last->second, T_map_camera, reach(elapsed_s));
}

bool Relocalizer::is_certain(const TrackOutcome& outcome) const {
  const Matrix6d information = edge_information(graph_, outcome.alignment.information);
  return largest_sigma(information.inverse(), 0) <= config_.max_sigma_m;
}

bool Relocalizer::sees_through_walls(const Situation& now, const TrackOutcome& outcome) const {
  const Pose T_map_camera = now.map.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera;
  const Matrix6d covariance = edge_information(graph_, outcome.alignment.information).inverse();
  return surfaces_.track(now.map, now.frame, outcome.reference, {T_map_camera, covariance}).is_contradicted;
}

// The bounds are less than the distance between rooms that are copies of each other.
bool Relocalizer::may_be_slip(const Situation& now, const Pose& T_map_camera) const {
  constexpr double kMost_m = 1.0, kMost_rad = 0.5;
  const auto last = now.motion.last_stamp();
  const auto lead = now.motion.dead_reckon(now.stamp()) ? now.motion.predict(now.map, now.stamp()) : std::nullopt;
  const auto moved = last ? now.motion.odometry_between(*last, now.stamp()) : std::nullopt;
  if (!lead || !moved) return false;
  return is_near(*lead, T_map_camera,
                 {config_.near_m + std::min(kMost_m, config_.slip_share * moved->path_m),
                  config_.near_rad + std::min(kMost_rad, config_.slip_share * moved->turned_rad)});
}

bool Relocalizer::confirms(const Situation& now, const Pose& T_map_camera) const {
  const double elapsed_s = (now.stamp() - found_->stamp).seconds();
  if (elapsed_s < 0.0 || elapsed_s > config_.memory_s) return false;
  const auto moved = now.motion.odometry_between(found_->stamp, now.stamp());
  if (moved) return is_near(found_->T_map_camera * moved->T_from_to, T_map_camera, {config_.near_m, config_.near_rad});
  return is_near(found_->T_map_camera, T_map_camera, reach(elapsed_s));
}

Relocalizer::Reach Relocalizer::reach(double elapsed_s) const {
  const double times = 1.0 + elapsed_s * config_.speed_m_s / config_.near_m;
  return {times * config_.near_m, times * config_.near_rad};
}

Relocalizer::Reach Relocalizer::reach(const Matrix6d& covariance) const {
  return {config_.near_m + 3.0 * largest_sigma(covariance, 0), config_.near_rad + 3.0 * largest_sigma(covariance, 3)};
}

bool Relocalizer::is_near(const Pose& T_expected, const Pose& T_found, const Reach& reach) {
  const Pose difference = T_expected.inverse() * T_found;
  return difference.translation().norm() <= reach.m && geometry::rotation_angle(difference.linear()) <= reach.rad;
}

}  // namespace lapis::slam
