#include "planner/core/candidates/alternatives.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "planner/core/candidates/old_places.hpp"
#include "planner/core/space/alternative_paths.hpp"
#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {
namespace {

constexpr std::size_t kMostRevisits = 5;  // of one decision: the nearest ones
constexpr double kSameHeading_rad = 0.5;

bool passes(const std::vector<Pose2>& path, const Pose2& pose, double apart_m) {
  return std::any_of(path.begin(), path.end(), [&](const Pose2& on_path) {
    return (on_path.p_map - pose.p_map).norm() < apart_m &&
           turn_between(on_path.yaw_rad, pose.yaw_rad) < kSameHeading_rad;
  });
}

/// The path to a candidate's goal through the first old place whose detour is not too long. It passes the place in the
/// direction of its key-frame, so that the camera sees what the key-frame saw.
std::optional<Path> path_past(const ProposalInput& in, const std::vector<OldPlace>& places, const Candidate& candidate,
                              double direct_m) {
  if (places.empty()) return std::nullopt;
  const PlanningGrid& grid = in.situation.grid;
  const PathConfig& config = in.config.path;
  const CostTree from_goal = grow_cost_tree(grid, config, {grid.cell_of(candidate.goal.p_map)});
  for (const OldPlace& place : places) {
    if (passes(candidate.path, place.pose, config.min_apart_m)) continue;
    const Cell beyond = cell_beyond(grid, place);
    if (beyond == place.cell || !from_goal.cost_m(beyond)) continue;
    Path path = straightened(grid, config, in.tree.path_to(place.cell));
    std::vector<Cell> back = from_goal.path_to(beyond);
    std::reverse(back.begin(), back.end());
    const Path rest = straightened(grid, config, back);
    path.length_m += distance(place.cell, beyond) * grid.resolution_m() + rest.length_m;
    if (path.length_m > config.max_detour * direct_m) continue;
    path.cells.insert(path.cells.end(), rest.cells.begin(), rest.cells.end());
    return path;
  }
  return std::nullopt;
}

/// Other paths to a candidate's goal: around other obstacles, and then, if there are fewer than wanted, through an old
/// place.
void add_alternatives(const ProposalInput& in, const std::vector<OldPlace>& places, const Candidate& candidate,
                      std::vector<Candidate>& all) {
  const PlanningGrid& grid = in.situation.grid;
  const int most = in.config.alternatives;
  const Cell from = grid.cell_of(in.situation.robot.p_map), to = grid.cell_of(candidate.goal.p_map);
  std::vector<Path> paths = find_alternatives(grid, in.config.path, from, to, 1 + most);
  if (paths.empty()) return;
  const double direct_m = paths.front().length_m;
  paths.erase(paths.begin());
  if (paths.size() < static_cast<std::size_t>(most)) {
    if (auto past = path_past(in, places, candidate, direct_m)) paths.push_back(*std::move(past));
  }
  for (const Path& path : paths) {
    Candidate& other = all.emplace_back(candidate);
    other.kind = CandidateKind::kAlternative;
    set_path(in, path, other);
  }
}

/// Other paths to the nearest open goal of every frontier.
void add_alternatives(const ProposalInput& in, const std::vector<OldPlace>& places,
                      std::vector<Candidate>& candidates) {
  std::map<std::uint32_t, std::size_t> nearest;  // index of the nearest open candidate, by frontier
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].is_open() || candidates[i].frontier == 0) continue;
    const auto [known, is_new] = nearest.try_emplace(candidates[i].frontier, i);
    if (!is_new && candidates[i].value.cost_m < candidates[known->second].value.cost_m) known->second = i;
  }
  std::vector<Candidate> others;
  for (const auto& entry : nearest) add_alternatives(in, places, candidates[entry.second], others);
  candidates.insert(candidates.end(), others.begin(), others.end());
}

void add_revisits(const ProposalInput& in, std::vector<OldPlace> places, std::vector<Candidate>& candidates) {
  std::stable_sort(places.begin(), places.end(), [&](const OldPlace& a, const OldPlace& b) {
    return *in.tree.cost_m(a.cell) < *in.tree.cost_m(b.cell);
  });
  places.resize(std::min(places.size(), kMostRevisits));
  for (const OldPlace& place : places) {
    const Viewpoint viewpoint{
        place.cell, {in.situation.grid.center_of(place.cell), place.pose.yaw_rad}, place.cell, 0.0};
    Candidate& candidate = candidates.emplace_back(candidate_at(in, 0, viewpoint));
    candidate.kind = CandidateKind::kRevisit;
    candidate.rejection = why_left_alone(in.memory.old_places, candidate.target_map, std::nullopt, in.memory.radius_m);
  }
}

}  // namespace

void add_alternatives_and_revisits(const ProposalInput& in, bool with_revisits, std::vector<Candidate>& candidates) {
  const Situation& s = in.situation;
  const auto& adrift = in.memory.adrift;
  const bool is_driven_back = adrift && adrift->sigma_m > adrift->budget_m;
  const bool may_revisit = with_revisits && in.config.revisit_sigma_m > 0.0 && !is_driven_back;
  if (in.config.alternatives == 0 && !may_revisit) return;
  const std::vector<OldPlace> places = old_places(in, in.config.hallucination);
  if (in.config.alternatives > 0) add_alternatives(in, places, candidates);
  if (may_revisit && !places.empty() && position_sigma_m(*s.graph) > in.config.revisit_sigma_m)
    add_revisits(in, places, candidates);
}

}  // namespace lapis::planner
