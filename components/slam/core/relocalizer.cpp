#include "slam/core/relocalizer.hpp"

#include <cmath>
#include <utility>

namespace lapis::slam {

using geometry::Pose;

TrackOutcome Relocalizer::search(const Map& map, const LoopDetector& places, const Tracker& tracker,
                                 const Frame& frame) const {
  TrackOutcome best;
  for (const KeyframeId id : places.resembling(frame)) {
    TrackOutcome outcome = tracker.recognize(map, frame, id);
    if (outcome.alignment.inliers < config_.min_inliers) continue;
    if (outcome.is_tracked && outcome.alignment.inliers > best.alignment.inliers) best = std::move(outcome);
  }
  if (!best.is_tracked) best.reason = "no place of the map is recognised";
  return best;
}

bool Relocalizer::believes(const Map& map, const MotionModel& motion, time::Time stamp, const TrackOutcome& outcome) {
  const Pose T_map_camera = map.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera;
  if (const auto expected = motion.expect(map, stamp)) {
    const double reach = 1.0 + 3.0 * std::sqrt(expected->covariance.topLeftCorner<3, 3>().trace()) / config_.near_m;
    if (is_near(expected->T_map_camera, T_map_camera, reach)) {
      hypothesis_.reset();
      return true;
    }
  }
  int confirmed = 0;
  if (hypothesis_) {
    const auto moved = motion.odometry_between(hypothesis_->stamp, stamp);
    const Pose T_expected = moved ? Pose(hypothesis_->T_map_camera * moved->T_from_to) : hypothesis_->T_map_camera;
    const double elapsed_s = (stamp - hypothesis_->stamp).seconds();
    const double reach = 1.0 + (moved ? 0.0 : elapsed_s * config_.speed_m_s / config_.near_m);
    if (elapsed_s <= config_.memory_s && is_near(T_expected, T_map_camera, reach))
      confirmed = hypothesis_->confirmed + 1;
  }
  if (confirmed >= config_.confirmations) {
    hypothesis_.reset();
    return true;
  }
  hypothesis_ = Hypothesis{stamp, T_map_camera, confirmed};
  return false;
}

bool Relocalizer::is_near(const Pose& T_expected, const Pose& T_found, double reach) const {
  const Pose difference = T_expected.inverse() * T_found;
  return difference.translation().norm() <= reach * config_.near_m &&
         geometry::rotation_angle(difference.linear()) <= reach * config_.near_rad;
}

}  // namespace lapis::slam
