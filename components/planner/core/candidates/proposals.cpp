#include "planner/core/candidates/proposals.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "planner/core/candidates/alternatives.hpp"
#include "planner/core/candidates/gap_views.hpp"

namespace lapis::planner {
namespace {

constexpr std::size_t kMostTracked = 5;  // of one decision: the newest ones

/// Ids of frontiers that are hidden from every reachable place in the current map.
std::set<std::uint32_t> hidden_ones(const std::vector<Candidate>& candidates) {
  std::set<std::uint32_t> hidden;
  for (const Candidate& candidate : candidates) {
    if (candidate.rejection == Rejection::kHidden) hidden.insert(candidate.frontier);
  }
  return hidden;
}

/// @param hidden set when no other candidate is left: frontiers that are long enough then need not be in sight (closer
/// looks). A failed closer look at a frontier in `hidden` is rejected as kHidden, because the frontier was not seen.
std::vector<Candidate> propose_frontiers(const ProposalInput& in,
                                         const std::optional<std::set<std::uint32_t>>& hidden = std::nullopt) {
  const auto& [s, tree, memory, config] = in;
  std::vector<Candidate> candidates;
  for (const auto& entry : s.frontiers.frontiers()) {
    const Frontier& frontier = entry.second;
    const bool is_room = frontier.length_m >= config.closer_look_length_m;
    const Sight sight = hidden && is_room ? Sight::kNotNeeded : Sight::kNeeded;
    const bool is_hidden = hidden && hidden->contains(frontier.id);
    const ViewpointResult found = sample_viewpoints(s.grid, tree, frontier, config.viewpoints, sight);
    if (found.viewpoints.empty()) candidates.push_back(rejected(frontier, found.rejection));
    for (const Viewpoint& viewpoint : found.viewpoints) {
      Candidate& candidate = candidates.emplace_back(candidate_at(in, frontier.id, viewpoint));
      if (sight == Sight::kNotNeeded) candidate.kind = CandidateKind::kCloserLook;
      if (is_failed_view(memory.failed_views, candidate.target_map, candidate.goal.p_map, memory.radius_m))
        candidate.rejection = Rejection::kFailedView;
      const Rejection why =
          why_left_alone(memory.left_alone, candidate.target_map, candidate.goal.p_map, memory.radius_m);
      candidate.rejection = std::max(candidate.rejection, why);
      if (is_hidden && is_geometric(candidate.rejection)) candidate.rejection = Rejection::kHidden;
    }
  }
  return candidates;
}

/// Slam may track again where it tracked before.
void add_tracked_places(const ProposalInput& in, std::vector<Candidate>& candidates) {
  const auto& [s, tree, memory, config] = in;
  if (!memory.adrift) return;
  std::size_t added = 0;
  for (const Pose2& pose : memory.adrift->tracked) {
    const Cell cell = s.grid.cell_of(pose.p_map);
    if (!s.grid.is_traversable(cell) || !tree.cost_m(cell)) continue;
    const Viewpoint viewpoint{cell, {s.grid.center_of(cell), pose.yaw_rad}, cell, 0.0};
    candidates.emplace_back(candidate_at(in, 0, viewpoint)).kind = CandidateKind::kTracked;
    if (++added == kMostTracked) return;
  }
}

void add_gap_views(const ProposalInput& in, std::vector<Candidate>& candidates) {
  if (!in.memory.looks_at_gaps || in.config.gaps.least_nats <= 0.0) return;
  for (const Viewpoint& view : gap_views(in.situation, in.tree, in.memory, in.config.gaps))
    candidates.emplace_back(candidate_at(in, 0, view)).kind = CandidateKind::kGap;
}

}  // namespace

void reject_unsure_ones(const std::optional<Adrift>& adrift, std::vector<Candidate>& candidates) {
  if (!adrift) return;
  for (Candidate& candidate : candidates) {
    // False when sigma_m is NaN.
    const bool is_sure = adrift->sigma_m + adrift->growth * candidate.value.cost_m <= adrift->budget_m;
    if (candidate.is_open() && !is_sure) candidate.rejection = Rejection::kUnsure;
  }
}

void reject_far_ones(const ProposalInput& in, std::vector<Candidate>& candidates) {
  std::vector<std::pair<int, double>> rank(candidates.size());  // rank within its frontier by cost, cost
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].is_open()) continue;
    order.push_back(i);
    rank[i].second = candidates[i].value.cost_m;
    for (const Candidate& other : candidates) {
      const bool is_before = other.frontier == candidates[i].frontier && other.is_open() &&
                             other.value.cost_m < candidates[i].value.cost_m;
      rank[i].first += is_before ? 1 : 0;
    }
    if (is_current_goal(candidates[i], in.memory)) rank[i] = {-1, 0.0};
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank[a] < rank[b]; });
  for (auto k = static_cast<std::size_t>(in.config.max_candidates); k < order.size(); ++k)
    candidates[order[k]].rejection = Rejection::kOutranked;
}

void add_last_resorts(const ProposalInput& in, std::vector<Candidate>& candidates) {
  const auto& adrift = in.memory.adrift;
  if (!is_any_open(candidates)) {
    candidates = propose_frontiers(in, hidden_ones(candidates));
    reject_unsure_ones(adrift, candidates);
  }
  if (!is_any_open(candidates)) {
    add_gap_views(in, candidates);
    reject_unsure_ones(adrift, candidates);
  }
  if (!is_any_open(candidates)) add_tracked_places(in, candidates);
}

std::vector<Candidate> propose_paths(const ProposalInput& in, bool with_revisits) {
  std::vector<Candidate> candidates = propose_frontiers(in);
  reject_unsure_ones(in.memory.adrift, candidates);
  add_last_resorts(in, candidates);
  reject_far_ones(in, candidates);
  add_alternatives_and_revisits(in, with_revisits, candidates);
  return candidates;
}

}  // namespace lapis::planner
