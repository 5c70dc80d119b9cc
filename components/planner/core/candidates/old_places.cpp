#include "planner/core/candidates/old_places.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "planner/core/space/line.hpp"
#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {
namespace {

constexpr double kAtGoal_m = 0.5;

bool is_open_line(const PlanningGrid& grid, Cell from, Cell to) {
  return walk_line(from, to, [&](Cell c, double) { return grid.is_traversable(c); });
}

}  // namespace

OldPlace place_of(const Situation& s, int node) {
  const Keyframe& keyframe = s.graph->keyframes[static_cast<std::size_t>(node)];
  const geometry::Pose T_map_base = keyframe.T_map_camera * s.T_base_camera.inverse();
  const Eigen::Vector3d forward = T_map_base.linear().col(0);
  const Eigen::Vector2d p = T_map_base.translation().head<2>();
  return {{p, std::atan2(forward.y(), forward.x())}, s.grid.cell_of(p)};
}

Candidate candidate_through(const ProposalInput& in, const OldPlace& place) {
  const PlanningGrid& grid = in.situation.grid;
  const Cell beyond = cell_beyond(grid, place);
  Path path = straightened(grid, in.config.path, in.tree.path_to(place.cell));
  if (beyond != place.cell) {
    path.cells.push_back(beyond);
    path.length_m += distance(place.cell, beyond) * grid.resolution_m();
  }
  Candidate candidate;
  candidate.kind = CandidateKind::kRevisit;
  candidate.goal = {grid.center_of(beyond), place.pose.yaw_rad};
  candidate.target_map = grid.center_of(place.cell);
  set_path(in, path, candidate);
  return candidate;
}

std::vector<OldPlace> old_places(const ProposalInput& in, const HallucinationConfig& config) {
  const Situation& s = in.situation;
  if (s.graph == nullptr || s.landmarks == nullptr) return {};
  std::vector<std::pair<int, int>> ranked;  // minus the number of shared landmarks, node
  for (int node = 0; node < s.graph->factor.node_count(); ++node) {
    const int landmarks = s.landmarks->shared_landmarks(node);
    const bool is_old = s.graph->path_from_newest_m[static_cast<std::size_t>(node)] >= config.min_loop_path_m;
    if (is_old && loop_probability(landmarks, config) >= kLikely) ranked.emplace_back(-landmarks, node);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<OldPlace> places;
  for (const auto& entry : ranked) {
    const OldPlace place = place_of(s, entry.second);
    const bool is_new = std::none_of(places.begin(), places.end(), [&](const OldPlace& other) {
      return (other.pose.p_map - place.pose.p_map).norm() < config.place_radius_m;
    });
    if (is_new && s.grid.is_traversable(place.cell) && in.tree.cost_m(place.cell)) places.push_back(place);
  }
  return places;
}

Cell cell_beyond(const PlanningGrid& grid, const OldPlace& place) {
  const Eigen::Vector2d heading(std::cos(place.pose.yaw_rad), std::sin(place.pose.yaw_rad));
  const Cell beyond = grid.cell_of(place.pose.p_map + kPass_m * heading);
  return is_open_line(grid, place.cell, beyond) ? beyond : place.cell;
}

std::vector<Candidate> propose_old_places(const ProposalInput& in) {
  const HallucinationConfig rules;
  std::vector<Candidate> candidates;
  for (const OldPlace& place : old_places(in, rules)) {
    Candidate candidate = candidate_through(in, place);
    if ((candidate.goal.p_map - in.situation.robot.p_map).norm() < kAtGoal_m) continue;
    const auto& visited = in.memory.visited_places;
    const bool is_visited = std::any_of(visited.begin(), visited.end(), [&](const Eigen::Vector2d& p_map) {
      return (p_map - candidate.target_map).norm() < rules.place_radius_m;
    });
    if (is_visited) candidate.rejection = Rejection::kLeftAlone;
    candidates.push_back(std::move(candidate));
  }
  return candidates;
}

}  // namespace lapis::planner
