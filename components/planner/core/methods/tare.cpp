#include "planner/core/methods/tare.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lapis::planner {
namespace {

/// The stops of TARE's tour; only the first max_candidates of them stay open.
std::vector<Candidate> propose_tour(const ProposalInput& in, const TareConfig& tare) {
  const auto& [s, tree, memory, config] = in;
  const geometry::PinholeCamera& camera = s.view.config().camera;
  const double fov_rad = 2.0 * std::atan(0.5 * camera.width / camera.fx);
  const Tour tour = plan_tour(
      {s.grid, s.frontiers, tree, s.robot, fov_rad, config.path, config.viewpoints, config.turn_cost_m_per_rad,
       memory.left_alone, memory.failed_views, memory.radius_m, memory.goal, config.keep_factor},
      tare);
  std::vector<Candidate> candidates;
  for (const TourStop& stop : tour.stops) {
    Candidate& candidate = candidates.emplace_back(candidate_at(in, stop.frontier, stop.viewpoint));
    candidate.value.tour_place = static_cast<int>(candidates.size());
    if (candidate.value.tour_place > config.max_candidates) candidate.rejection = Rejection::kOutranked;
  }
  for (const auto& [id, reason] : tour.missed) candidates.push_back(rejected(s.frontiers.frontiers().at(id), reason));
  return candidates;
}

/// Orders the open candidates by cost, as if they were the stops of a tour; used when the tour has no open stop.
std::vector<Candidate> nearest_first(std::vector<Candidate> candidates) {
  std::vector<Candidate*> open;
  for (Candidate& candidate : candidates) {
    if (candidate.is_open()) open.push_back(&candidate);
  }
  std::stable_sort(open.begin(), open.end(),
                   [](const Candidate* a, const Candidate* b) { return a->value.cost_m < b->value.cost_m; });
  for (std::size_t i = 0; i < open.size(); ++i) open[i]->value.tour_place = static_cast<int>(i) + 1;
  return candidates;
}

}  // namespace

std::vector<Candidate> Tare::propose(const ProposalInput& in) const {
  std::vector<Candidate> candidates = propose_tour(in, config_);
  reject_unsure_ones(in.memory.adrift, candidates);
  if (is_any_open(candidates)) return candidates;
  add_last_resorts(in, candidates);
  reject_far_ones(in, candidates);
  return nearest_first(std::move(candidates));
}

}  // namespace lapis::planner
