#include "planner/core/candidates/candidate_paths.hpp"

#include <algorithm>

#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {
namespace {

constexpr double kSameGoal_m = 0.5;  // goals that are nearer to each other count as the same goal

// Turning on the spot at both ends of a path [rad]. At the corners in between the robot turns while it drives.
double turning(const Pose2& robot, const std::vector<Pose2>& path) {
  if (path.size() < 2) return turn_between(robot.yaw_rad, path.back().yaw_rad);
  return turn_between(robot.yaw_rad, path.front().yaw_rad) +
         turn_between(path[path.size() - 2].yaw_rad, path.back().yaw_rad);
}

}  // namespace

const char* name_of(CandidateKind kind) {
  switch (kind) {
    case CandidateKind::kFrontier: return "frontier";
    case CandidateKind::kAlternative: return "alternative";
    case CandidateKind::kCloserLook: return "closer_look";
    case CandidateKind::kTracked: return "tracked";
    case CandidateKind::kGap: return "gap";
    case CandidateKind::kRevisit: return "revisit";
  }
  return "";
}

Candidate rejected(const Frontier& frontier, Rejection reason) {
  Candidate candidate;
  candidate.frontier = frontier.id;
  candidate.goal.p_map = candidate.target_map = frontier.centroid_map;
  candidate.rejection = reason;
  return candidate;
}

Candidate candidate_at(const ProposalInput& in, std::uint32_t frontier, const Viewpoint& viewpoint) {
  const PlanningGrid& grid = in.situation.grid;
  Candidate candidate;
  candidate.frontier = frontier;
  candidate.goal = viewpoint.pose;
  candidate.target_map = grid.center_of(viewpoint.target);
  set_path(in, straightened(grid, in.config.path, in.tree.path_to(viewpoint.cell)), candidate);
  return candidate;
}

void set_path(const ProposalInput& in, const Path& path, Candidate& candidate) {
  const Situation& s = in.situation;
  candidate.points = points_of(s.grid, path);
  candidate.points.front() = s.robot.p_map;
  candidate.path = poses_along(candidate.points, in.config.view_spacing_m, candidate.goal.yaw_rad);
  candidate.value.cost_m = path.length_m + in.config.turn_cost_m_per_rad * turning(s.robot, candidate.path);
}

bool is_current_goal(const Candidate& candidate, const Memory& memory) {
  return memory.goal && (memory.goal->p_map - candidate.goal.p_map).norm() < kSameGoal_m;
}

bool is_any_open(const std::vector<Candidate>& candidates) {
  return std::any_of(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.is_open(); });
}

}  // namespace lapis::planner
