#include "slam/core/relocalizer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "slam/core/pose_graph.hpp"

namespace lapis::slam {

using geometry::Pose;

TrackOutcome Relocalizer::search(const Map& map, const LoopDetector& places, const Tracker& tracker,
                                 const Frame& frame) const {
  constexpr double kAsGood = 0.7, kApart_m = 1.0;
  const auto position = [&](const TrackOutcome& outcome) {
    return Eigen::Vector3d(map.keyframe(outcome.reference).T_map_camera *
                           outcome.alignment.T_reference_camera.translation());
  };
  std::vector<TrackOutcome> found;
  for (const KeyframeId id : places.resembling(frame)) {
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
    return other.alignment.inliers >= kAsGood * best.alignment.inliers &&
           (position(other) - position(best)).norm() > kApart_m;
  });
  if (!is_ambiguous) return best;
  best.is_tracked = false;
  best.reason = "several places of the map look like this";
  return best;
}

bool Relocalizer::believes(const Map& map, const MotionModel& motion, time::Time stamp, const TrackOutcome& outcome) {
  const Pose T_map_camera = map.keyframe(outcome.reference).T_map_camera * outcome.alignment.T_reference_camera;
  bool is_believed = motion_leads_to(map, motion, stamp, T_map_camera);
  if (!is_believed) {
    if (!is_distinct(outcome)) return false;
    if (motion.dead_reckon(stamp) && !may_be_slip(map, motion, stamp, T_map_camera)) {
      is_believed = weigh(motion, stamp, T_map_camera, outcome);
      if (!is_believed) ++doubted_;
    } else {
      remember(motion, stamp, T_map_camera);
      is_believed =
          hypothesis_->confirmed >= config_.confirmations || is_within_reach(map, motion, stamp, T_map_camera);
    }
  }
  if (is_believed) {
    hypothesis_.reset();
    elsewhere_.reset();
  }
  return is_believed;
}

void Relocalizer::remember(const MotionModel& motion, time::Time stamp, const Pose& T_map_camera) {
  const int confirmed = hypothesis_ && confirms(motion, stamp, T_map_camera) ? hypothesis_->confirmed + 1 : 0;
  hypothesis_ = Hypothesis{stamp, T_map_camera, confirmed, 0.0, {}, 0, 0};
}

bool Relocalizer::weigh(const MotionModel& motion, time::Time stamp, const Pose& T_map_camera,
                        const TrackOutcome& outcome) {
  constexpr int kMostAgainst = 3;
  std::vector<LandmarkId> shown;
  for (const Match& match : outcome.inliers) shown.push_back(match.landmark);
  std::sort(shown.begin(), shown.end());
  const Hypothesis fresh{stamp, T_map_camera, 0, 0.0, shown, 1, 0};
  const auto moved = elsewhere_ ? motion.odometry_between(elsewhere_->stamp, stamp) : std::nullopt;
  if (!moved) {
    elsewhere_ = fresh;
    return false;
  }
  Hypothesis& place = *elsewhere_;
  const double sigma_m = largest_sigma(moved->covariance, 0);
  if (!is_near(place.T_map_camera * moved->T_from_to, T_map_camera, 1.0 + 3.0 * sigma_m / config_.near_m)) {
    if (++place.against >= kMostAgainst) elsewhere_ = fresh;
    return false;
  }
  place.stamp = stamp;
  place.T_map_camera = T_map_camera;
  place.path_m += moved->path_m;
  std::vector<LandmarkId> common;
  std::set_intersection(shown.begin(), shown.end(), place.landmarks.begin(), place.landmarks.end(),
                        std::back_inserter(common));
  if (common.empty()) {
    ++place.views;
    std::vector<LandmarkId> all;
    std::set_union(shown.begin(), shown.end(), place.landmarks.begin(), place.landmarks.end(), std::back_inserter(all));
    place.landmarks = std::move(all);
  }
  return place.path_m >= config_.evidence_m && place.views >= config_.evidence_views;
}

bool Relocalizer::may_be_slip(const Map& map, const MotionModel& motion, time::Time stamp,
                              const Pose& T_map_camera) const {
  const auto last = motion.last_stamp();
  const auto expected = motion.predict(map, stamp);
  const auto moved = last ? motion.odometry_between(*last, stamp) : std::nullopt;
  if (!expected || !moved) return false;
  const Pose difference = expected->inverse() * T_map_camera;
  return difference.translation().norm() <= config_.near_m + config_.slip_share * moved->path_m &&
         geometry::rotation_angle(difference.linear()) <= config_.near_rad + config_.slip_share * moved->turned_rad;
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
