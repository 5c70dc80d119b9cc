#include "planner/core/candidates/worthy_revisits.hpp"

#include <algorithm>
#include <cmath>

#include "planner/core/candidates/old_places.hpp"
#include "planner/core/uncertainty/map_worth.hpp"

namespace lapis::planner {
namespace {

constexpr double kVisit_m = 1.0;  // of travelled path, of which one key-frame is judged
constexpr double kApart_m = 1.0, kApart_rad = 0.5;

struct Revisit {
  OldPlace place;
  double nats_per_m;
};

/// Of every stretch of path, the old key-frame that shares most landmarks with others.
std::vector<int> representatives(const Situation& s, const HallucinationConfig& config) {
  std::vector<int> nodes;
  for (int node = 0; node < s.graph->factor.node_count(); ++node) {
    const auto i = static_cast<std::size_t>(node);
    const int landmarks = s.landmarks->shared_landmarks(node);
    if (s.graph->path_from_newest_m[i] < config.min_loop_path_m || loop_probability(landmarks, config) < kLikely)
      continue;
    const auto stretch = [&](int of) {
      return std::floor(s.graph->travelled_m[static_cast<std::size_t>(of)] / kVisit_m);
    };
    if (nodes.empty() || stretch(nodes.back()) != stretch(node)) {
      nodes.push_back(node);
    } else if (s.landmarks->shared_landmarks(nodes.back()) < landmarks) {
      nodes.back() = node;
    }
  }
  return nodes;
}

std::vector<Revisit> ranked(const ProposalInput& in, const HallucinationConfig& config) {
  const Situation& s = in.situation;
  std::vector<Revisit> revisits;
  for (const int node : representatives(s, config)) {
    const OldPlace place = place_of(s, node);
    const auto cost_m = in.tree.cost_m(place.cell);
    if (!s.grid.is_traversable(place.cell) || !cost_m) continue;
    const PossibleLoop loop{node, place.pose.p_map, *cost_m,
                            loop_probability(s.landmarks->shared_landmarks(node), config)};
    const double nats_per_m = s.worth->secured_nats({loop}) / (*cost_m + kPass_m);
    if (nats_per_m > 0.0) revisits.push_back({place, nats_per_m});
  }
  std::stable_sort(revisits.begin(), revisits.end(),
                   [](const Revisit& a, const Revisit& b) { return a.nats_per_m > b.nats_per_m; });
  return revisits;
}

bool is_same(const Pose2& a, const Pose2& b) {
  return (a.p_map - b.p_map).norm() < kApart_m && turn_between(a.yaw_rad, b.yaw_rad) < kApart_rad;
}

bool is_left_alone(const ProposalInput& in, const Eigen::Vector2d& place_map) {
  const auto& visited = in.memory.visited_places;
  return why_left_alone(in.memory.old_places, place_map, std::nullopt, in.memory.radius_m) != Rejection::kNone ||
         std::any_of(visited.begin(), visited.end(),
                     [&](const Eigen::Vector2d& p_map) { return (p_map - place_map).norm() < in.memory.radius_m; });
}

}  // namespace

std::vector<Candidate> propose_worthy_revisits(const ProposalInput& in) {
  const Situation& s = in.situation;
  if (s.worth == nullptr || s.graph == nullptr || s.landmarks == nullptr) return {};
  std::vector<Candidate> candidates;
  std::vector<Pose2> places;
  for (const Revisit& revisit : ranked(in, in.config.hallucination)) {
    const Pose2& pose = revisit.place.pose;
    if (candidates.size() == kMostWorthyRevisits) break;
    if (std::any_of(places.begin(), places.end(), [&](const Pose2& other) { return is_same(other, pose); })) continue;
    Candidate candidate = candidate_through(in, revisit.place);
    if (is_left_alone(in, candidate.target_map)) continue;
    places.push_back(pose);
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

}  // namespace lapis::planner
