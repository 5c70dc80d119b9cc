#include "slam/core/loops/map_joiner.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "slam/core/motion/motion_model.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

constexpr std::size_t kMostSightings = 200;  // the newest ones
// From this many key-frames that agree on, others look where these say.
constexpr std::size_t kLead = 2;
// Of the pose at which a key-frame should see something.
constexpr double kSigma_m = 0.1, kSigma_rad = 0.03;
// Sub-maps bend: at this distance sightings that agree may differ by twice as much as beside each other.
constexpr double kDoubled_m = 5.0;

bool has_seen(const Keyframe& keyframe) { return !keyframe.features.empty(); }

double extent_m(const std::vector<Eigen::Vector3d>& positions) {
  double most_m = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) most_m = std::max(most_m, (positions[i] - positions[j]).norm());
  }
  return most_m;
}

std::vector<LandmarkId> landmarks_of(const std::vector<Match>& matches) {
  std::vector<LandmarkId> ids;
  for (const Match& match : matches) ids.push_back(match.landmark);
  std::sort(ids.begin(), ids.end());
  return ids;
}

// The key-frame of a part that is nearest to a pose in it, if it is near enough to be compared.
std::optional<KeyframeId> nearest_keyframe(const LoopConfig& config, const Map& map, KeyframeId part,
                                           const Pose& T_part_camera) {
  std::optional<KeyframeId> nearest;
  double least = 1.0;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.sub_map != part || !has_seen(keyframe)) continue;
    const Pose T = keyframe.T_map_camera.inverse() * T_part_camera;
    const double distance =
        T.translation().norm() / config.near_m + geometry::rotation_angle(T.linear()) / config.near_rad;
    if (distance >= least) continue;
    least = distance;
    nearest = keyframe.id;
  }
  return nearest;
}

Eigen::Vector3d middle_of(const Map& map, const std::vector<LandmarkId>& landmarks) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const LandmarkId id : landmarks) sum += map.landmark(id).p_map;
  return sum / static_cast<double>(std::max<std::size_t>(1, landmarks.size()));
}

}  // namespace

void MapJoiner::look(const Map& map, const LoopDetector& places, const Tracker& tracker, const Frame& frame,
                     KeyframeId id) {
  follow(map);
  const auto is_elsewhere = [&](const Keyframe& other) {
    return other.sub_map != map.keyframe(id).sub_map && has_seen(other);
  };
  if (std::none_of(map.keyframes().begin(), map.keyframes().end(), is_elsewhere)) return;
  look_where_expected(map, places, tracker, frame, id);
  for (const KeyframeId other :
       places.resembling(frame, [&](KeyframeId candidate) { return is_elsewhere(map.keyframe(candidate)); })) {
    const auto seen = places.compare(map, tracker, frame, id, {other, std::nullopt});
    if (seen) add(map, {.edge = seen->edge, .landmarks = landmarks_of(seen->matches)});
  }
}

// Junctions and bundle adjustment move key-frames, and parts are joined or given up.
void MapJoiner::follow(const Map& map) {
  std::erase_if(sightings_, [&](Sighting& sighting) { return !place(map, sighting); });
}

// False when the sighting is not of two parts any more.
bool MapJoiner::place(const Map& map, Sighting& sighting) const {
  const Keyframe &from = map.keyframe(sighting.edge.from), &to = map.keyframe(sighting.edge.to);
  if (from.sub_map == to.sub_map || !has_seen(from) || !has_seen(to)) return false;
  const Pose T_from_to = from.T_map_camera * sighting.edge.T_from_to * to.T_map_camera.inverse();
  const bool leads_to_younger = from.sub_map < to.sub_map;
  sighting.older = std::min(from.sub_map, to.sub_map);
  sighting.younger = std::max(from.sub_map, to.sub_map);
  sighting.T_older_younger = leads_to_younger ? T_from_to : Pose(T_from_to.inverse());
  sighting.p_younger = (leads_to_younger ? to : from).T_map_camera.translation();
  const Eigen::Vector3d middle = middle_of(map, sighting.landmarks);
  sighting.shown_younger = leads_to_younger ? sighting.T_older_younger.inverse() * middle : middle;
  return true;
}

// One key-frame that says the same twice counts once.
void MapJoiner::add(const Map& map, Sighting sighting) {
  if (!place(map, sighting)) return;
  const auto is_said = [&](const Sighting& other) {
    return other.edge.to == sighting.edge.to && other.is_against == sighting.is_against && agree(other, sighting);
  };
  if (std::any_of(sightings_.begin(), sightings_.end(), is_said)) return;
  if (sightings_.size() == kMostSightings) sightings_.erase(sightings_.begin());
  sightings_.push_back(std::move(sighting));
}

// Where a few sightings agree, the others can be sought on purpose, and their absence says something as well.
void MapJoiner::look_where_expected(const Map& map, const LoopDetector& places, const Tracker& tracker,
                                    const Frame& frame, KeyframeId id) {
  const auto lead = best_answer();
  if (!lead || lead->agreeing.size() < kLead) return;
  const Sighting& by = *lead->by;
  const KeyframeId part = map.keyframe(id).sub_map;
  if (part != by.older && part != by.younger) return;
  const bool is_younger = part == by.younger;
  const Pose T_other_part = is_younger ? by.T_older_younger : Pose(by.T_older_younger.inverse());
  const Pose T_other_camera = T_other_part * map.keyframe(id).T_map_camera;
  const auto nearest = nearest_keyframe(config_.loop, map, is_younger ? by.older : by.younger, T_other_camera);
  if (!nearest) return;
  if (const auto seen = places.compare(map, tracker, frame, id, {*nearest, T_other_camera})) {
    return add(map, {.edge = seen->edge, .landmarks = landmarks_of(seen->matches)});
  }
  geometry::Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(kSigma_m), Eigen::Vector3d::Constant(kSigma_rad);
  const Matrix6d covariance = sigma.cwiseAbs2().asDiagonal();
  if (!surfaces_.track(map, frame, *nearest, {T_other_camera, covariance}).is_contradicted) return;
  const Pose T_nearest_camera = map.keyframe(*nearest).T_map_camera.inverse() * T_other_camera;
  add(map, {.edge = {*nearest, id, EdgeType::kLoopClosure, T_nearest_camera}, .landmarks = {}, .is_against = true});
}

bool MapJoiner::agree(const Sighting& a, const Sighting& b) const {
  if (a.older != b.older || a.younger != b.younger) return false;
  const double times = 1.0 + (a.p_younger - b.p_younger).norm() / kDoubled_m;
  const Eigen::Vector3d apart = a.T_older_younger * b.p_younger - b.T_older_younger * b.p_younger;
  const Eigen::Matrix3d turned = a.T_older_younger.linear().transpose() * b.T_older_younger.linear();
  return apart.norm() <= times * config_.loop.max_disagreement_m &&
         geometry::rotation_angle(turned) <= times * config_.loop.max_disagreement_rad;
}

MapJoiner::Answer MapJoiner::answer_of(const Sighting& sighting) const {
  Answer answer{&sighting, {}, 0};
  for (const Sighting& other : sightings_) {
    if (!agree(sighting, other)) continue;
    if (other.is_against) ++answer.against;
    if (!other.is_against) answer.agreeing.push_back(&other);
  }
  return answer;
}

// The answer on which most key-frames agree; the newest one of several.
std::optional<MapJoiner::Answer> MapJoiner::best_answer() const {
  std::optional<Answer> best;
  for (const Sighting& sighting : sightings_) {
    if (sighting.is_against) continue;
    Answer answer = answer_of(sighting);
    if (!best || answer.agreeing.size() >= best->agreeing.size()) best = std::move(answer);
  }
  return best;
}

// Most key-frames that agree on another answer for the same parts.
std::size_t MapJoiner::rivals(const Answer& answer) const {
  std::size_t most = 0;
  for (const Sighting& other : sightings_) {
    const bool is_same_question = other.older == answer.by->older && other.younger == answer.by->younger;
    if (other.is_against || !is_same_question || agree(*answer.by, other)) continue;
    most = std::max(most, answer_of(other).agreeing.size());
  }
  return most;
}

// Sightings that share no landmarks.
std::vector<const MapJoiner::Sighting*> MapJoiner::views(const Answer& answer) const {
  std::vector<const Sighting*> found;
  std::vector<LandmarkId> seen, common, all;
  for (const Sighting* sighting : answer.agreeing) {
    common.clear();
    all.clear();
    const auto& shown = sighting->landmarks;
    std::set_intersection(seen.begin(), seen.end(), shown.begin(), shown.end(), std::back_inserter(common));
    if (!common.empty()) continue;
    std::set_union(seen.begin(), seen.end(), shown.begin(), shown.end(), std::back_inserter(all));
    seen.swap(all);
    found.push_back(sighting);
  }
  return found;
}

std::optional<Junction> MapJoiner::junction() {
  evidence_ = {};
  const auto answer = best_answer();
  if (!answer) return std::nullopt;
  std::vector<Eigen::Vector3d> cameras, shown;
  for (const Sighting* sighting : answer->agreeing) {
    cameras.push_back(sighting->p_younger);
    shown.push_back(sighting->shown_younger);
  }
  const std::vector<const Sighting*> independent = views(*answer);
  evidence_ = {answer->agreeing.size(), std::max(rivals(*answer), answer->against), independent.size(),
               extent_m(cameras), extent_m(shown)};
  if (!is_enough(evidence_)) return std::nullopt;
  const Sighting& by = *answer->by;
  Junction found{by.younger, by.older, by.T_older_younger, by.edge, {}};
  for (const Sighting* view : independent) {
    if (view != &by) found.loops.push_back(view->edge);
  }
  return found;
}

bool MapJoiner::is_enough(const Evidence& evidence) const {
  const SubMapConfig& needed = config_.sub_map;
  const auto agreeing = static_cast<double>(evidence.keyframes), others = static_cast<double>(evidence.others);
  return evidence.span_m >= needed.evidence_m && evidence.shown_m >= needed.room_m &&
         evidence.views >= static_cast<std::size_t>(needed.evidence_views) &&
         agreeing - others > config_.tracker.rival_sigmas * std::sqrt(agreeing + others);
}

bool MapJoiner::is_large_enough(const Map& map, KeyframeId part) const {
  std::vector<Eigen::Vector3d> positions;
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.sub_map == part) positions.push_back(keyframe.T_map_camera.translation());
  }
  return extent_m(positions) >= config_.sub_map.evidence_m;
}

}  // namespace lapis::slam
