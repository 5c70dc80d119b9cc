#include "slam/core/front_end/front_end.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "slam/core/frame/surface.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/motion/covariance.hpp"
#include "slam/core/tracking/keyframe_rule.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

void set_pose(const Known& known, const RelativeCamera& camera, TrackingResult& result) {
  result.keyframe_id = camera.reference;
  result.T_map_keyframe = known.map.keyframe(camera.reference).T_map_camera;
  result.T_keyframe_camera = camera.T_reference_camera;
  result.covariance = camera.covariance;
  result.map_covariance =
      compound_covariance(known.graph.covariance(camera.reference), camera.T_reference_camera, camera.covariance);
}

// Fuses vision and odometry, each weighted with its information: a bare wall says nothing about the path along it.
// Odometry loses weight where it is further from vision than kMostApart_sigmas, as when wheels slip (Huber).
RelativeCamera fuse(const Map& map, const RelativeCamera& seen, const std::optional<RelativeCamera>& reckoned) {
  constexpr double kMostApart_sigmas = 3.0;
  if (!reckoned) return seen;
  const Pose T_map_reckoned = map.keyframe(reckoned->reference).T_map_camera * reckoned->T_reference_camera;
  const Pose T_map_seen = map.keyframe(seen.reference).T_map_camera * seen.T_reference_camera;
  const geometry::Vector6d difference = geometry::se3_log(T_map_seen.inverse() * T_map_reckoned);
  const Matrix6d sum = seen.covariance + reckoned->covariance;
  const double sigmas = std::sqrt(difference.dot(sum.inverse() * difference));
  const Matrix6d odometry = std::min(1.0, kMostApart_sigmas / sigmas) * reckoned->covariance.inverse();
  const Matrix6d together = (seen.covariance.inverse() + odometry).inverse();
  return {seen.reference, seen.T_reference_camera * geometry::se3_exp(together * odometry * difference), together};
}

// The newest key-frame that is in no sub-map.
KeyframeId newest_of_map(const Map& map) {
  const auto& keyframes = map.keyframes();
  return std::find_if(keyframes.rbegin(), keyframes.rend(),
                      [](const Keyframe& keyframe) { return keyframe.sub_map == kWholeMap; })
      ->id;
}

}  // namespace

FrameOutcome FrontEnd::begin(const Known& known, const Frame& frame) {
  // Without odometry, a map of few features, or of surfaces, would be lost for ever as soon as they do not determine a
  // pose.
  const time::Time stamp = frame.input->stamp;
  const bool has_odometry = known.motion.odometry_at(stamp).has_value();
  const int needed = features_to_begin(has_odometry);
  const bool has_features = frame.features_with_depth >= needed;
  FrameOutcome outcome;
  if (has_features || (has_odometry && shows_surfaces(frame))) {
    outcome.result.state = TrackingState::kTracking;
    outcome.result.source = has_features ? PoseSource::kVision : PoseSource::kSurfaces;
    outcome.wants_keyframe = outcome.begins_part = true;
    held_stamp_ = stamp;
  } else {
    outcome.result = without_vision(
        known, stamp,
        "the view shows too little to begin (a blank wall?): " + std::to_string(frame.features_with_depth) +
            " features with depth, " + std::to_string(needed) + " needed" +
            (has_odometry ? ", and too few surfaces" : "; without odometry, surfaces are not enough to begin"));
  }
  outcome.result.features = static_cast<std::uint32_t>(frame.features.size());
  return outcome;
}

int FrontEnd::features_to_begin(bool has_odometry) const {
  const int alone = std::min(config_.tracker.min_first_features, config_.features.max_features / 2);
  const int least = config_.tracker.min_matches;
  return has_odometry ? least : std::max(least, alone);
}

FrameOutcome FrontEnd::locate(const Known& known, const Frame& frame) {
  TrackOutcome seen = find_pose(known, frame);
  if (!seen.is_tracked) return continue_without_features(known, frame, seen.reason);
  blind_frames_ = unknown_frames_ = 0;
  is_placed_ = true;
  ++frames_since_keyframe_;
  const bool wants_keyframe = needs_keyframe_at(known.map, seen);
  return hold(known, frame, std::move(seen), PoseSource::kVision, wants_keyframe);
}

std::optional<Pose> FrontEnd::guess(const Known& known, const Frame& frame) const {
  const auto predicted = known.motion.predict(known.map, frame.input->stamp);
  const TrackOutcome found =
      tracker_.track(known.map, frame, predicted, search_radius_px(), [](const TrackOutcome&) { return true; });
  if (!found.is_tracked) return std::nullopt;
  return Pose(known.map.keyframe(found.reference).T_map_camera * found.alignment.T_reference_camera);
}

TrackingResult FrontEnd::without_vision(const Known& known, time::Time stamp, const std::string& reason) const {
  TrackingResult result;
  result.state = known.map.empty() ? TrackingState::kInitializing : TrackingState::kLost;
  result.reason = is_placed_ ? reason : "looking for a place in the saved map: " + reason;
  const auto reckoned = known.motion.dead_reckon(stamp);
  if (!reckoned || !set_drift(known, stamp, result)) return result;
  if (is_contradicted()) {
    result.reason = "what odometry says contradicts what the camera sees: the robot was carried, or its wheels spin";
  } else if (result.drift_m > config_.odometry.max_drift_m) {
    result.reason = "odometry alone, and its sigma is beyond slam.odometry.max_drift_m: " + reason;
  } else {
    result.state = TrackingState::kDeadReckoning;
    result.source = PoseSource::kOdometry;
    set_pose(known, *reckoned, result);
  }
  return result;
}

void FrontEnd::enter_keyframe(const Map& map, KeyframeId id) {
  reference_ = id;
  frames_since_keyframe_ = 0;
  renew(map);
}

void FrontEnd::give_up(const Map& map) {
  held_stamp_.reset();
  enter_keyframe(map, newest_of_map(map));
}

void FrontEnd::resume(const Map& map, KeyframeId reference, std::optional<time::Time> held_stamp, bool leads_on) {
  is_placed_ = leads_on;
  held_stamp_ = held_stamp;
  reference_ = leads_on || map.keyframe(reference).sub_map == kWholeMap ? reference : newest_of_map(map);
  renew(map);
}

// Searches near the pose that motion predicts, then in the whole map; the result is believed only when motion or the
// next frames agree.
TrackOutcome FrontEnd::find_pose(const Known& known, const Frame& frame) {
  constexpr double kForgets = 0.8;
  awaits_confirmation_ = false;
  const auto predicted = known.motion.predict(known.map, frame.input->stamp);
  const Relocalizer::Situation now{known.map, known.graph, known.motion, known.places,
                                   tracker_,  frame,       reference_,   is_contradicted()};
  TrackOutcome outcome =
      tracker_.track(known.map, frame, predicted, search_radius_px(),
                     [&](const TrackOutcome& found) { return relocalizer_.motion_leads_to(now, found); });
  surprise_px_ = predicted && outcome.is_tracked
                     ? std::max(kForgets * surprise_px_, tracker_.surprise_px(known.map, frame, outcome, *predicted))
                     : kUnknownSurprise_px;
  if (!outcome.is_tracked) {
    if (static_cast<int>(frame.features.size()) < config_.tracker.min_inliers) return outcome;
    TrackOutcome found = relocalizer_.search(now);
    if (!found.is_tracked) return predicted ? outcome : found;
    outcome = std::move(found);
  }
  const Relocalizer::Verdict verdict = relocalizer_.judge(now, outcome);
  if (verdict == Relocalizer::Verdict::kBelieved) return outcome;
  outcome.is_tracked = false;
  awaits_confirmation_ = verdict == Relocalizer::Verdict::kAwaitsMore;
  outcome.reason = awaits_confirmation_ ? "a recognised place awaits confirmation"
                                        : "a recognised place is not where the camera was, and may be a copy";
  return outcome;
}

// Where motion has predicted well, features are looked for nearby: a texture that repeats itself has others like them.
double FrontEnd::search_radius_px() const {
  constexpr double kTimesSurprise = 3.0, kLeast_px = 4.0;
  return std::min(config_.matcher.search_radius_px, kLeast_px + kTimesSurprise * surprise_px_);
}

// Result for a pose by vision or surfaces. When the camera is back in a part of the map that odometry alone connects to
// the newest key-frame, a key-frame closes the cycle, so that the stretch between can be corrected.
FrameOutcome FrontEnd::hold(const Known& known, const Frame& frame, TrackOutcome seen, PoseSource source,
                            bool wants_keyframe) {
  contradictions_ = fits_ = 0;
  held_stamp_ = frame.input->stamp;
  FrameOutcome outcome;
  outcome.ends_drift = known.graph.are_apart(seen.reference, known.map.keyframes().back().id);
  outcome.wants_keyframe = wants_keyframe || outcome.ends_drift;
  // After a recovery the camera may be beside another key-frame than the one tracked last.
  if (seen.reference != reference_) tracker_.set_reference(known.map, seen.reference);
  reference_ = seen.reference;
  outcome.result = result_of(known, frame, seen);
  outcome.result.source = source;
  outcome.seen = std::move(seen);
  return outcome;
}

// Result without features: by surfaces where motion leads, else by odometry. When the camera sees enough features to
// begin with, but recognises none of them, the map continues there.
FrameOutcome FrontEnd::continue_without_features(const Known& known, const Frame& frame, const std::string& reason) {
  const bool could_start = frame.features_with_depth >= config_.tracker.min_matches;
  blind_frames_ = could_start ? blind_frames_ + 1 : 0;
  if (is_somewhere_new(known, frame)) return begin(known, frame);
  const auto reckoned = known.motion.dead_reckon(frame.input->stamp);
  if (!reckoned) return continue_blind(known, frame, reason, false);
  ++frames_since_keyframe_;
  const MotionModel::Expected expected{
      known.map.keyframe(reckoned->reference).T_map_camera * reckoned->T_reference_camera, reckoned->covariance};
  TrackOutcome aligned = surfaces_.track(known.map, frame, reference_, expected);
  count_contradictions(aligned, could_start && !aligned.is_tracked && should_be_known(known.map, *reckoned));
  const bool fits_by_chance = is_contradicted() && fits_ < config_.tracker.max_contradictions;
  if (!aligned.is_tracked || fits_by_chance) {
    const bool is_new_view = aligned.is_new_view && !could_start && !awaits_confirmation_;
    return continue_blind(known, frame, reason + "; " + aligned.reason, is_new_view);
  }
  const bool begins_anew = blind_frames_ >= config_.tracker.max_blind_frames;
  if (begins_anew) blind_frames_ = 0;
  const bool wants_keyframe = begins_anew || has_moved(aligned.alignment.T_reference_camera);
  return hold(known, frame, std::move(aligned), PoseSource::kSurfaces, wants_keyframe);
}

// Whether the camera has long seen enough to begin with, but no place of the map that recovery believes, and odometry
// does not lead on either.
bool FrontEnd::is_somewhere_new(const Known& known, const Frame& frame) {
  const bool can_begin = frame.features_with_depth >= features_to_begin(false);
  if (!can_begin || known.motion.odometry_at(frame.input->stamp)) {
    unknown_frames_ = 0;
  } else if (!awaits_confirmation_) {
    ++unknown_frames_;
  }
  if (config_.sub_map.after_frames == 0 || unknown_frames_ < config_.sub_map.after_frames) return false;
  unknown_frames_ = 0;
  return true;
}

// Result by odometry alone. When there is enough to see, the map continues at the pose of odometry. Surfaces that no
// key-frame has seen yet become those of a new key-frame, so that the next frames can be aligned with them.
FrameOutcome FrontEnd::continue_blind(const Known& known, const Frame& frame, const std::string& reason,
                                      bool is_new_view) {
  FrameOutcome outcome;
  TrackingResult& result = outcome.result;
  result = without_vision(known, frame.input->stamp, reason);
  result.features = static_cast<std::uint32_t>(frame.features.size());
  if (result.state != TrackingState::kDeadReckoning) return outcome;
  const bool begins_anew = blind_frames_ >= config_.tracker.max_blind_frames && contradictions_ == 0;
  if (begins_anew) {
    blind_frames_ = 0;
    result.state = TrackingState::kTracking;
    result.reason.clear();
  }
  outcome.wants_keyframe = begins_anew || (is_new_view && has_moved(result.T_keyframe_camera) && shows_surfaces(frame));
  return outcome;
}

TrackingResult FrontEnd::result_of(const Known& known, const Frame& frame, const TrackOutcome& seen) const {
  TrackingResult result;
  result.state = TrackingState::kTracking;
  const RelativeCamera camera{seen.reference, seen.alignment.T_reference_camera,
                              edge_information(config_.pose_graph, seen.alignment.information).inverse()};
  auto reckoned = known.motion.dead_reckon(frame.input->stamp);
  // Where odometry alone connects the two references, the reckoned pose would lead astray.
  if (reckoned && known.graph.are_apart(reckoned->reference, camera.reference)) reckoned.reset();
  set_pose(known, fuse(known.map, camera, reckoned), result);
  result.features = static_cast<std::uint32_t>(frame.features.size());
  result.matches = static_cast<std::uint32_t>(seen.matches);
  result.inliers = static_cast<std::uint32_t>(seen.alignment.inliers);
  result.rms_px = seen.alignment.rms_px;
  return result;
}

// False when odometry does not reach back to the last pose by vision or surfaces: the drift is then unknown.
bool FrontEnd::set_drift(const Known& known, time::Time stamp, TrackingResult& result) const {
  const auto motion = held_stamp_ ? known.motion.odometry_between(*held_stamp_, stamp) : std::nullopt;
  if (!motion) return false;
  result.drift_m = largest_sigma(motion->covariance, 0);
  result.drift_rad = largest_sigma(motion->covariance, 3);
  return true;
}

void FrontEnd::count_contradictions(const TrackOutcome& aligned, bool is_unknown) {
  if (aligned.is_contradicted || is_unknown) {
    ++contradictions_;
  } else if (!is_contradicted()) {
    contradictions_ = 0;
  }
  fits_ = aligned.is_tracked ? fits_ + 1 : 0;
}

// True when for too long the camera has not seen what was mapped. Vision ends that, or surfaces that fit for as long.
bool FrontEnd::is_contradicted() const { return contradictions_ >= config_.tracker.max_contradictions; }

// This near a key-frame with this many landmarks, the camera recognises something if it is where odometry says.
bool FrontEnd::should_be_known(const Map& map, const RelativeCamera& camera) const {
  const auto& landmarks = map.keyframe(camera.reference).landmarks;
  const auto known = std::count_if(landmarks.begin(), landmarks.end(), [](auto id) { return id != kNoLandmark; });
  return known >= 2 * config_.tracker.min_matches && !has_moved(camera.T_reference_camera);
}

// Whether the camera is far enough from the reference for another key-frame.
bool FrontEnd::has_moved(const Pose& T_reference_camera) const {
  KeyframeEvidence evidence;
  evidence.frames_since_keyframe = frames_since_keyframe_;
  evidence.T_reference_camera = T_reference_camera;
  return needs_keyframe(config_.keyframe, evidence);
}

bool FrontEnd::shows_surfaces(const Frame& frame) const {
  if (!config_.surface.enabled) return false;
  const auto samples = sample_surface(config_.surface, config_.noise, frame.input->camera, frame.input->depth);
  return samples.size() >= static_cast<std::size_t>(config_.surface.min_matches);
}

bool FrontEnd::needs_keyframe_at(const Map& map, const TrackOutcome& seen) const {
  KeyframeEvidence evidence;
  evidence.frames_since_keyframe = frames_since_keyframe_;
  evidence.T_reference_camera = seen.alignment.T_reference_camera;
  const auto& landmarks = map.keyframe(seen.reference).landmarks;
  std::vector<LandmarkId> known;
  std::copy_if(landmarks.begin(), landmarks.end(), std::back_inserter(known),
               [](LandmarkId id) { return id != kNoLandmark; });
  std::sort(known.begin(), known.end());
  evidence.reference_landmarks = static_cast<int>(known.size());
  evidence.tracked_landmarks =
      static_cast<int>(std::count_if(seen.inliers.begin(), seen.inliers.end(), [&](const Match& match) {
        return std::binary_search(known.begin(), known.end(), match.landmark);
      }));
  return needs_keyframe(config_.keyframe, evidence);
}

}  // namespace lapis::slam
