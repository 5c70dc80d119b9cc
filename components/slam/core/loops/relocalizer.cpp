#include "slam/core/loops/relocalizer.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <utility>

#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {

using geometry::Matrix6d;
using geometry::Pose;

namespace {

// Rooms that are copies of each other are at least so far apart, and so are the copies of a texture on a floor.
constexpr double kCopies_m = 3.0;
// From further away a key-frame's view is hardly recognised.
constexpr double kView_m = 2.0;

Pose pose_of(const Map& map, const TrackOutcome& outcome) {
  return map.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera;
}

}  // namespace

TrackOutcome Relocalizer::search(const Situation& now) {
  TrackOutcome nothing;
  nothing.reason = "no place of the map is recognised";
  if (recognized_ && now.map.keyframe(*recognized_).sub_map != now.sub_map()) recognized_.reset();
  auto keyframe = recognized_;
  if (!keyframe) {
    const std::vector<KeyframeId> all = candidates(now);
    keyframe = all[turn_++ % all.size()];
  }
  TrackOutcome found = compare(now, *keyframe);
  recognized_ = found.is_tracked ? keyframe : std::nullopt;
  return found.is_tracked ? found : nothing;
}

// The most similar first, and at last the key-frame beside which the camera was.
std::vector<KeyframeId> Relocalizer::candidates(const Situation& now) const {
  std::function<bool(const Keyframe&)> is_near = [](const Keyframe&) { return true; };
  if (is_bound(now)) {
    is_near = [here = vicinity(now)](const Keyframe& keyframe) {
      return (keyframe.T_map_camera.translation() - here.T_map_camera.translation()).norm() <= here.reach.m + kView_m;
    };
  }
  std::vector<KeyframeId> all = now.places.resembling(now.frame, [&](KeyframeId id) {
    const Keyframe& keyframe = now.map.keyframe(id);
    return keyframe.sub_map == now.sub_map() && is_near(keyframe);
  });
  if (std::find(all.begin(), all.end(), now.reference) == all.end()) all.push_back(now.reference);
  return all;
}

TrackOutcome Relocalizer::compare(const Situation& now, KeyframeId keyframe) const {
  TrackOutcome outcome = now.tracker.recognize(now.map, now.frame, keyframe);
  outcome.is_tracked = outcome.is_tracked && outcome.alignment.inliers >= config_.relocalization.min_inliers;
  return outcome;
}

Relocalizer::Verdict Relocalizer::judge(const Situation& now, const TrackOutcome& outcome) {
  const Verdict verdict = motion_leads_to(now, outcome) ? Verdict::kBelieved : judge_unled(now, outcome);
  if (verdict == Verdict::kBelieved) {
    found_.reset();
    elsewhere_.reset();
    turn_ = 0;
  }
  if (verdict != Verdict::kAwaitsMore) recognized_.reset();
  return verdict;
}

Relocalizer::Verdict Relocalizer::judge_unled(const Situation& now, const TrackOutcome& outcome) {
  const Pose T_map_camera = pose_of(now.map, outcome);
  if (is_bound(now)) return judge_bound(now, T_map_camera, outcome);
  if (!is_certain(outcome)) return Verdict::kAwaitsMore;
  const auto last = now.motion.last_stamp();
  // After a gap, odometry does not tell how the robot has moved since its last pose.
  const bool has_odometry = last ? now.motion.odometry_between(*last, now.stamp()).has_value()
                                 : now.motion.odometry_at(now.stamp()).has_value();
  if (!has_odometry && sees_through_walls(now, outcome)) return Verdict::kAwaitsMore;
  const bool is_contradicted = last && has_odometry;
  bool is_believed = false;
  if (!is_contradicted || may_be_slip(now, T_map_camera)) {
    is_believed = is_found_alone(now, T_map_camera, outcome) || is_within_reach(now, T_map_camera);
  } else {
    is_believed = is_within_reach(now, T_map_camera) || weigh(now, T_map_camera, outcome);
  }
  return is_believed ? Verdict::kBelieved : Verdict::kAwaitsMore;
}

Relocalizer::Verdict Relocalizer::judge_bound(const Situation& now, const Pose& T_map_camera,
                                              const TrackOutcome& outcome) {
  const Vicinity here = vicinity(now);
  if (!is_certain(outcome) || !is_near(here.T_map_camera, T_map_camera, here.reach)) return Verdict::kNotHere;
  if (sees_through_walls(now, outcome)) return Verdict::kNotHere;
  const bool is_again = is_found_again(now, T_map_camera);
  if (is_within_reach(now, T_map_camera)) return Verdict::kBelieved;
  if (!is_again) return Verdict::kAwaitsMore;
  if (here.excludes_copies || !has_copy(now, outcome)) return Verdict::kBelieved;
  found_.reset();
  return Verdict::kNotHere;
}

bool Relocalizer::is_bound(const Situation& now) const {
  return config_.sub_map.after_frames > 0 && !now.motion.odometry_at(now.stamp());
}

// As long as the camera cannot have come as far as a copy of where it was, the place nearest to its last pose is the
// right one. Later it may have been carried anywhere, and only a camera that seems not to have moved is where it was.
Relocalizer::Vicinity Relocalizer::vicinity(const Situation& now) const {
  const auto last = now.motion.last_pose(now.map);
  const Pose T_last = last ? last->second : now.map.keyframe(now.reference).T_map_camera;
  const double elapsed_s = last ? (now.stamp() - last->first).seconds() : -1.0;
  if (const Reach far = reach(elapsed_s); elapsed_s >= 0.0 && far.m <= kCopies_m) {
    return {T_last, {std::min(far.m, 0.5 * kCopies_m), std::numbers::pi}, true};
  }
  const RelocalizationConfig& same = config_.relocalization;
  const KeyframeConfig& beside = config_.keyframe;
  return {T_last, {same.near_m + beside.max_translation_m, same.near_rad + beside.max_rotation_rad}, false};
}

bool Relocalizer::has_copy(const Situation& now, const TrackOutcome& outcome) const {
  constexpr double kAsGood = 0.7;
  constexpr Reach kSame{1.0, 0.5};
  const auto is_other = [&](KeyframeId id) {
    return id != outcome.reference && now.map.keyframe(id).sub_map == now.sub_map();
  };
  const auto all = now.places.resembling(now.frame, is_other);
  return std::any_of(all.begin(), all.end(), [&](KeyframeId id) {
    const TrackOutcome other = compare(now, id);
    return other.is_tracked && other.alignment.inliers >= kAsGood * outcome.alignment.inliers &&
           !is_near(pose_of(now.map, outcome), pose_of(now.map, other), kSame);
  });
}

bool Relocalizer::is_found_again(const Situation& now, const Pose& T_map_camera) {
  const int again = found_ && confirms(now, T_map_camera) ? found_->again + 1 : 0;
  found_ = Found{now.stamp(), T_map_camera, again};
  return again >= config_.relocalization.confirmations;
}

bool Relocalizer::is_found_alone(const Situation& now, const Pose& T_map_camera, const TrackOutcome& outcome) {
  if (!is_found_again(now, T_map_camera)) return false;
  if (!has_copy(now, outcome)) return true;
  found_.reset();
  recognized_.reset();
  return false;
}

bool Relocalizer::weigh(const Situation& now, const Pose& T_map_camera, const TrackOutcome& outcome) {
  constexpr int kMostAgainst = 3;
  constexpr double kEnoughTurned_rad = 2.0;
  std::vector<LandmarkId> shown;
  for (const Match& match : outcome.inliers) shown.push_back(match.landmark);
  std::sort(shown.begin(), shown.end());
  const auto begin = [&] {
    if (has_copy(now, outcome)) return false;
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
  std::vector<LandmarkId> common, all;
  std::set_intersection(shown.begin(), shown.end(), place.landmarks.begin(), place.landmarks.end(),
                        std::back_inserter(common));
  if (common.empty() && has_copy(now, outcome)) return false;
  place.against = 0;
  place.stamp = now.stamp();
  place.reference = outcome.reference;
  place.T_reference_camera = outcome.alignment.T_reference_camera;
  place.path_m += moved->path_m;
  place.turned_rad += moved->turned_rad;
  if (common.empty()) {
    ++place.views;
    std::set_union(shown.begin(), shown.end(), place.landmarks.begin(), place.landmarks.end(), std::back_inserter(all));
    place.landmarks = std::move(all);
  }
  const bool has_turned = now.is_odometry_refuted && place.turned_rad >= kEnoughTurned_rad;
  return place.views >= config_.relocalization.evidence_views &&
         (place.path_m >= config_.relocalization.evidence_m || has_turned);
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
  const Pose T_map_camera = pose_of(now.map, outcome);
  Reach within = reach(lead->covariance);
  if (!now.motion.dead_reckon(now.stamp())) {
    const double elapsed_s = std::max(kLeastElapsed_s, (now.stamp() - *now.motion.last_stamp()).seconds());
    const double times = elapsed_s * config_.relocalization.speed_m_s / config_.relocalization.near_m;
    within.m += (times - 1.0) * config_.relocalization.near_m;
    within.rad += (times - 1.0) * config_.relocalization.near_rad;
  }
  return is_near(lead->T_map_camera, T_map_camera, within);
}

bool Relocalizer::is_within_reach(const Situation& now, const Pose& T_map_camera) const {
  const auto last = now.motion.last_pose(now.map);
  if (!last || now.motion.expect(now.map, now.stamp())) return false;
  const double elapsed_s = (now.stamp() - last->first).seconds();
  return elapsed_s >= 0.0 && elapsed_s <= config_.relocalization.patience_s &&
         is_near(last->second, T_map_camera, reach(elapsed_s));
}

bool Relocalizer::is_certain(const TrackOutcome& outcome) const {
  const Matrix6d information = edge_information(config_.pose_graph, outcome.alignment.information);
  return largest_sigma(information.inverse(), 0) <= config_.relocalization.max_sigma_m;
}

bool Relocalizer::sees_through_walls(const Situation& now, const TrackOutcome& outcome) const {
  const Pose T_map_camera = pose_of(now.map, outcome);
  const Matrix6d covariance = edge_information(config_.pose_graph, outcome.alignment.information).inverse();
  return surfaces_.track(now.map, now.frame, outcome.reference, {T_map_camera, covariance}).is_contradicted;
}

// The bounds are less than the distance between rooms that are copies of each other.
bool Relocalizer::may_be_slip(const Situation& now, const Pose& T_map_camera) const {
  constexpr double kMost_m = 1.0, kMost_rad = 0.5;
  const auto last = now.motion.last_stamp();
  const auto lead = now.motion.dead_reckon(now.stamp()) ? now.motion.predict(now.map, now.stamp()) : std::nullopt;
  const auto moved = last ? now.motion.odometry_between(*last, now.stamp()) : std::nullopt;
  if (!lead || !moved) return false;
  return is_near(
      *lead, T_map_camera,
      {config_.relocalization.near_m + std::min(kMost_m, config_.relocalization.slip_share * moved->path_m),
       config_.relocalization.near_rad + std::min(kMost_rad, config_.relocalization.slip_share * moved->turned_rad)});
}

bool Relocalizer::confirms(const Situation& now, const Pose& T_map_camera) const {
  const double elapsed_s = (now.stamp() - found_->stamp).seconds();
  if (elapsed_s < 0.0 || elapsed_s > config_.relocalization.memory_s) return false;
  const auto moved = now.motion.odometry_between(found_->stamp, now.stamp());
  if (moved)
    return is_near(found_->T_map_camera * moved->T_from_to, T_map_camera,
                   {config_.relocalization.near_m, config_.relocalization.near_rad});
  return is_near(found_->T_map_camera, T_map_camera, reach(elapsed_s));
}

Relocalizer::Reach Relocalizer::reach(double elapsed_s) const {
  const double times = 1.0 + elapsed_s * config_.relocalization.speed_m_s / config_.relocalization.near_m;
  return {times * config_.relocalization.near_m, times * config_.relocalization.near_rad};
}

Relocalizer::Reach Relocalizer::reach(const Matrix6d& covariance) const {
  return {config_.relocalization.near_m + 3.0 * largest_sigma(covariance, 0),
          config_.relocalization.near_rad + 3.0 * largest_sigma(covariance, 3)};
}

bool Relocalizer::is_near(const Pose& T_expected, const Pose& T_found, const Reach& reach) {
  const Pose difference = T_expected.inverse() * T_found;
  return difference.translation().norm() <= reach.m && geometry::rotation_angle(difference.linear()) <= reach.rad;
}

}  // namespace lapis::slam
