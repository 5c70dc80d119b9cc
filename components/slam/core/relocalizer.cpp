#include "slam/core/relocalizer.hpp"

#include <cmath>
#include <utility>

#include "slam/core/pose_graph.hpp"

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
  bool is_believed = motion_leads_to(map, motion, stamp, T_map_camera);
  if (!is_believed) {
    if (!is_distinct(outcome)) return false;
    const int confirmed = hypothesis_ && confirms(motion, stamp, T_map_camera) ? hypothesis_->confirmed + 1 : 0;
    hypothesis_ = Hypothesis{stamp, T_map_camera, confirmed};
    is_believed = confirmed >= config_.confirmations || is_within_reach(map, motion, stamp, T_map_camera);
  }
  if (is_believed) hypothesis_.reset();
  return is_believed;
}

bool Relocalizer::motion_leads_to(const Map& map, const MotionModel& motion, time::Time stamp,
                                  const Pose& T_map_camera) const {
  const auto expected = motion.expect(map, stamp);
  if (!expected) return false;
  const double sigma_m = std::sqrt(expected->covariance.topLeftCorner<3, 3>().trace());
  return is_near(expected->T_map_camera, T_map_camera, 1.0 + 3.0 * sigma_m / config_.near_m);
}

bool Relocalizer::is_within_reach(const Map& map, const MotionModel& motion, time::Time stamp,
                                  const Pose& T_map_camera) const {
  const auto last = motion.last_pose(map);
  if (!last || motion.expect(map, stamp)) return false;
  const double elapsed_s = (stamp - last->first).seconds();
  return elapsed_s >= 0.0 && elapsed_s <= config_.patience_s && is_near(last->second, T_map_camera, reach(elapsed_s));
}

bool Relocalizer::is_distinct(const TrackOutcome& outcome) const {
  const geometry::Matrix6d information = edge_information(graph_, outcome.alignment.information);
  const double matches = outcome.matches;
  return outcome.alignment.inliers >= 0.5 * (matches + config_.majority_sigmas * std::sqrt(matches)) &&
         largest_sigma(information.inverse(), 0) <= config_.max_sigma_m;
}

bool Relocalizer::confirms(const MotionModel& motion, time::Time stamp, const Pose& T_map_camera) const {
  const double elapsed_s = (stamp - hypothesis_->stamp).seconds();
  if (elapsed_s < 0.0 || elapsed_s > config_.memory_s) return false;
  const auto moved = motion.odometry_between(hypothesis_->stamp, stamp);
  if (moved) return is_near(hypothesis_->T_map_camera * moved->T_from_to, T_map_camera, 1.0);
  return is_near(hypothesis_->T_map_camera, T_map_camera, reach(elapsed_s));
}

double Relocalizer::reach(double elapsed_s) const { return 1.0 + elapsed_s * config_.speed_m_s / config_.near_m; }

bool Relocalizer::is_near(const Pose& T_expected, const Pose& T_found, double reach) const {
  const Pose difference = T_expected.inverse() * T_found;
  return difference.translation().norm() <= reach * config_.near_m &&
         geometry::rotation_angle(difference.linear()) <= reach * config_.near_rad;
}

}  // namespace lapis::slam
