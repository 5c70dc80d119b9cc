#include "slam/core/loops/loop_detector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "slam/core/motion/covariance.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

// Up to four edges use an observation of a key-frame (two along the path, a pair of loops), where in a chain two do:
// docs/decisions/0025.
constexpr double kLoopShare = 0.5;
// Bound on the squared Mahalanobis distance of a loop from the graph: 99.9 % quantile of six degrees of freedom. The
// optimiser has a stricter one (graduated_weights.hpp).
constexpr double kPlausible = 22.46;

double path_m(const Map& map, KeyframeId from, KeyframeId to) {
  double length_m = 0.0;
  for (KeyframeId id = from; id < to; ++id) {
    length_m += (map.keyframe(id + 1).T_map_camera.translation() - map.keyframe(id).T_map_camera.translation()).norm();
  }
  return length_m;
}

}  // namespace

bool is_plausible(const geometry::Vector6d& error, const Matrix6d& covariance) {
  constexpr double kMoreThanBelieved = 3.0, kCopies_m = 1.0;
  const double more = std::clamp(kMoreThanBelieved * kCopies_m / error.head<3>().norm(), 1.0, kMoreThanBelieved);
  return error.dot(covariance.inverse() * error) <= more * more * kPlausible;
}

std::vector<KeyframeId> LoopDetector::resembling(const Frame& frame,
                                                 const std::function<bool(KeyframeId)>& is_wanted) const {
  std::vector<KeyframeId> found;
  const auto most = static_cast<std::size_t>(config_.loop.candidates);
  for (const auto& candidate : index_.query(frame.features, most, is_wanted)) found.push_back(candidate.keyframe);
  return found;
}

void LoopDetector::restore(const Map& map) {
  for (const Keyframe& keyframe : map.keyframes()) index_.add(keyframe.id, keyframe.features);
}

std::vector<PoseGraphEdge> LoopDetector::add(const Map& map, const SlamGraph& graph, const Tracker& tracker,
                                             const Frame& frame, KeyframeId id) {
  std::vector<PoseGraphEdge> loops;
  const auto found = config_.loop.enabled ? verify(map, graph, tracker, frame, id) : std::nullopt;
  index_.add(id, map.keyframe(id).features);
  if (!found) return loops;
  if (pending_ && id - pending_->to <= static_cast<KeyframeId>(config_.loop.confirm_within) &&
      agrees(map, *pending_, *found)) {
    if (revisits_.empty() || revisits_.back().to != pending_->to) revisits_.push_back({pending_->from, pending_->to});
    revisits_.push_back({found->from, id});
    if (!closed_ || path_m(map, *closed_, id) >= config_.loop.spacing_m) {
      loops = {*pending_, *found};
      closed_ = id;
    }
  }
  pending_ = found;
  return loops;
}

// Candidates by appearance, and the nearest key-frame according to the map.
std::vector<LoopDetector::Candidate> LoopDetector::candidates(const Map& map, const Frame& frame, KeyframeId id) const {
  std::vector<Candidate> found;
  const auto gap = static_cast<KeyframeId>(config_.loop.min_gap);
  if (id < gap) return found;
  const std::vector<KeyframeId> covisible = map.covisible(id, map.keyframes().size());
  const auto is_new = [&](KeyframeId other) {
    return std::find(covisible.begin(), covisible.end(), other) == covisible.end();
  };
  const auto is_here = [&](KeyframeId other) { return map.keyframe(other).sub_map == map.keyframe(id).sub_map; };
  const Pose T_map_camera = map.keyframe(id).T_map_camera;
  double nearest = 1.0;
  std::optional<KeyframeId> beside;
  for (KeyframeId other = 0; other < id - gap; ++other) {
    const Pose T = map.keyframe(other).T_map_camera.inverse() * T_map_camera;
    const double distance =
        T.translation().norm() / config_.loop.near_m + geometry::rotation_angle(T.linear()) / config_.loop.near_rad;
    if (distance >= nearest || !is_here(other) || !is_new(other)) continue;
    nearest = distance;
    beside = other;
  }
  if (beside) found.push_back({*beside, T_map_camera});
  for (const KeyframeId other : resembling(frame, [&](KeyframeId k) { return k < id - gap && is_here(k); })) {
    if (is_new(other)) found.push_back({other, std::nullopt});
  }
  return found;
}

std::optional<LoopDetector::Sighting> LoopDetector::compare(const Map& map, const Tracker& tracker, const Frame& frame,
                                                            KeyframeId id, const Candidate& candidate) const {
  TrackOutcome outcome = tracker.recognize(map, frame, candidate.keyframe, candidate.T_map_camera);
  if (!outcome.is_tracked || outcome.alignment.inliers < config_.loop.min_inliers) return std::nullopt;
  const PoseGraphEdge edge{candidate.keyframe, id, EdgeType::kLoopClosure, outcome.alignment.T_reference_camera,
                           edge_information(config_.pose_graph, kLoopShare * outcome.alignment.information)};
  const Matrix6d covariance = edge.information.inverse();
  if (largest_sigma(covariance, 0) > config_.loop.max_sigma_m) return std::nullopt;
  if (largest_sigma(covariance, 3) > config_.loop.max_sigma_rad) return std::nullopt;
  return Sighting{edge, std::move(outcome.inliers)};
}

std::optional<PoseGraphEdge> LoopDetector::verify(const Map& map, const SlamGraph& graph, const Tracker& tracker,
                                                  const Frame& frame, KeyframeId id) const {
  for (const Candidate& candidate : candidates(map, frame, id)) {
    const auto sighting = compare(map, tracker, frame, id, candidate);
    if (!sighting) continue;
    const PoseGraphEdge& edge = sighting->edge;
    const Pose T_from_to = map.keyframe(edge.from).T_map_camera.inverse() * map.keyframe(id).T_map_camera;
    const geometry::Vector6d error = geometry::se3_log(T_from_to.inverse() * edge.T_from_to);
    const Matrix6d expected = graph.relative_covariance(map, edge.from, id) + edge.information.inverse();
    if (!is_plausible(error, expected)) continue;
    return edge;
  }
  return std::nullopt;
}

// The two loops and the map's relative poses between their key-frames form a cycle, which must close.
bool LoopDetector::agrees(const Map& map, const PoseGraphEdge& earlier, const PoseGraphEdge& later) const {
  const auto T_map = [&](KeyframeId id) { return map.keyframe(id).T_map_camera; };
  const Pose T_expected = T_map(later.from).inverse() * T_map(earlier.from) * earlier.T_from_to *
                          T_map(earlier.to).inverse() * T_map(later.to);
  const Pose difference = T_expected.inverse() * later.T_from_to;
  return difference.translation().norm() <= config_.loop.max_disagreement_m &&
         geometry::rotation_angle(difference.linear()) <= config_.loop.max_disagreement_rad;
}

}  // namespace lapis::slam
