#include "planner/core/decision/decision.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {
namespace {

constexpr double kSameGoal_m = 0.5;  // goals nearer to each other are one

Candidate rejected(const Frontier& frontier, std::string reason) {
  Candidate candidate;
  candidate.frontier = frontier.id;
  candidate.goal.p_map = candidate.target_map = frontier.centroid_map;
  candidate.rejection = std::move(reason);
  return candidate;
}

double turn_between(double a, double b) { return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi)); }

// Turning at both ends of a way; corners in between are driven through.
double turning(const Pose2& robot, const std::vector<Pose2>& way) {
  if (way.size() < 2) return turn_between(robot.yaw_rad, way.back().yaw_rad);
  return turn_between(robot.yaw_rad, way.front().yaw_rad) +
         turn_between(way[way.size() - 2].yaw_rad, way.back().yaw_rad);
}

void add_way(const Situation& s, const CostTree& tree, const Viewpoint& viewpoint, const DecisionConfig& config,
             Candidate& candidate) {
  const Path path = straightened(s.grid, config.path, tree.path_to(viewpoint.cell));
  candidate.points = points_of(s.grid, path);
  candidate.points.front() = s.robot.p_map;
  candidate.way = poses_along(candidate.points, config.view_spacing_m, viewpoint.pose.yaw_rad);
  candidate.value.cost_m = path.length_m + config.turn_cost_m_per_rad * turning(s.robot, candidate.way);
}

Candidate candidate_at(const Situation& s, const CostTree& tree, std::uint32_t frontier, const Viewpoint& viewpoint,
                       const DecisionConfig& config) {
  Candidate candidate;
  candidate.frontier = frontier;
  candidate.goal = viewpoint.pose;
  candidate.target_map = s.grid.center_of(viewpoint.target);
  add_way(s, tree, viewpoint, config, candidate);
  return candidate;
}

bool is_left_alone(const Eigen::Vector2d& target_map, const Memory& memory) {
  return std::any_of(memory.left_alone.begin(), memory.left_alone.end(),
                     [&](const Eigen::Vector2d& place) { return (place - target_map).norm() <= memory.radius_m; });
}

std::vector<Candidate> propose(const Situation& s, const CostTree& tree, const Memory& memory,
                               const DecisionConfig& config) {
  std::vector<Candidate> candidates;
  for (const auto& entry : s.frontiers.frontiers()) {
    const Frontier& frontier = entry.second;
    const ViewpointResult found = sample_viewpoints(s.grid, tree, frontier, config.viewpoints);
    if (found.status != ViewpointStatus::kFound) candidates.push_back(rejected(frontier, reason_of(found.status)));
    for (const Viewpoint& viewpoint : found.viewpoints) {
      Candidate& candidate = candidates.emplace_back(candidate_at(s, tree, frontier.id, viewpoint, config));
      if (is_left_alone(candidate.target_map, memory)) candidate.rejection = kLeftAlone;
    }
  }
  return candidates;
}

// The stops of TARE's tour; as many of the first ones as may be looked at.
std::vector<Candidate> propose_tour(const Situation& s, const CostTree& tree, const Memory& memory,
                                    const DecisionConfig& config) {
  const geometry::PinholeCamera& camera = s.view.config().camera;
  const double fov_rad = 2.0 * std::atan(0.5 * camera.width / camera.fx);
  const Tour tour =
      plan_tour({s.grid, s.frontiers, tree, s.robot, fov_rad, config.path, config.viewpoints,
                 config.turn_cost_m_per_rad, memory.left_alone, memory.radius_m, memory.goal, config.keep_factor},
                config.tare);
  std::vector<Candidate> candidates;
  for (const TourStop& stop : tour.stops) {
    Candidate& candidate = candidates.emplace_back(candidate_at(s, tree, stop.frontier, stop.viewpoint, config));
    candidate.value.tour_place = static_cast<int>(candidates.size());
    if (candidate.value.tour_place > config.max_candidates)
      candidate.rejection = "more than " + std::to_string(config.max_candidates) + " others come before";
  }
  for (const auto& [id, reason] : tour.missed) candidates.push_back(rejected(s.frontiers.frontiers().at(id), reason));
  return candidates;
}

// Keeps those with the shortest ways, but of every frontier the nearest one before the second of any.
void reject_far_ones(std::vector<Candidate>& candidates, int most) {
  std::vector<std::pair<int, double>> rank(candidates.size());  // place within the frontier, cost
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].rejection.empty()) continue;
    order.push_back(i);
    rank[i].second = candidates[i].value.cost_m;
    for (const Candidate& other : candidates) {
      const bool is_before = other.frontier == candidates[i].frontier && other.rejection.empty() &&
                             other.value.cost_m < candidates[i].value.cost_m;
      rank[i].first += is_before ? 1 : 0;
    }
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank[a] < rank[b]; });
  for (auto k = static_cast<std::size_t>(most); k < order.size(); ++k)
    candidates[order[k]].rejection = "more than " + std::to_string(most) + " others are nearer";
}

geometry::Pose camera_pose(const Situation& s, const Pose2& pose) {
  geometry::Pose T_map_base = geometry::Pose::Identity();
  T_map_base.translate(Eigen::Vector3d(pose.p_map.x(), pose.p_map.y(), 0.0));
  T_map_base.rotate(Eigen::AngleAxisd(pose.yaw_rad, Eigen::Vector3d::UnitZ()));
  return T_map_base * s.T_base_camera;
}

ViewPath views_along(const Situation& s, const std::vector<Pose2>& way) {
  ViewPath views;
  for (const Pose2& pose : way) views.push_back(camera_pose(s, pose));
  return views;
}

std::vector<Candidate*> open_ones(std::vector<Candidate>& candidates) {
  std::vector<Candidate*> open;
  for (Candidate& candidate : candidates) {
    if (candidate.rejection.empty()) open.push_back(&candidate);
  }
  return open;
}

void add_information(const Situation& s, const std::vector<Candidate*>& open) {
  std::vector<ViewPath> paths, goals;
  for (const Candidate* candidate : open) {
    paths.push_back(views_along(s, candidate->way));
    goals.push_back({paths.back().back()});
  }
  const std::vector<double> of_paths = path_information(s.field, s.view, std::span<const ViewPath>(paths));
  const std::vector<double> of_goals =
      path_information(s.field, s.view, std::span<const ViewPath>(goals), Counting::kEveryRay);
  for (std::size_t i = 0; i < open.size(); ++i) {
    open[i]->value.path_information = of_paths[i];
    open[i]->value.goal_information = of_goals[i];
  }
}

std::vector<geometry::Pose> nodes_along(const Situation& s, const Candidate& candidate, double spacing_m) {
  std::vector<geometry::Pose> nodes = views_along(s, poses_along(candidate.points, spacing_m, candidate.goal.yaw_rad));
  if (nodes.size() > 1) nodes.erase(nodes.begin());  // the robot is there already
  return nodes;
}

// Empty, or what is wrong with the graph.
std::string add_gain(const Situation& s, const DecisionConfig& config, Candidate& candidate) {
  const auto nodes = nodes_along(s, candidate, config.node_spacing_m);
  const Hallucination path =
      hallucinate(*s.graph, *s.landmarks, s.field, s.view.config().camera, nodes, config.hallucination);
  const auto gain = expect_gain(*s.graph, path, config.sigma_limit_voxels * s.grid.resolution_m());
  if (const auto* error = std::get_if<GraphError>(&gain)) return error->message;
  const auto literal = literal_d_optimality(*s.graph, path);
  if (const auto* error = std::get_if<GraphError>(&literal)) return error->message;
  candidate.gain = std::get<ExpectedGain>(gain);
  candidate.places = static_cast<int>(path.places.size());
  candidate.value.loop_gain = candidate.gain.saturated_loop_gain;
  const int n = s.graph->factor.node_count();
  candidate.value.d_optimality = config.method == Method::kFixedN
                                     ? d_optimality(n, s.graph->factor.log_trees() + candidate.gain.fixed_n_change)
                                     : std::get<double>(literal);
  return "";
}

bool is_current_goal(const Candidate& candidate, const Memory& memory) {
  return memory.goal && (memory.goal->p_map - candidate.goal.p_map).norm() < kSameGoal_m;
}

std::optional<std::size_t> best_by(const std::vector<Candidate>& candidates, Method method, const Memory& memory,
                                   const DecisionConfig& config) {
  std::optional<std::size_t> best;
  double most = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].rejection.empty()) continue;
    const double bonus = is_current_goal(candidates[i], memory) ? config.keep_factor : 1.0;
    const double worth = bonus * utility(method, candidates[i].value, config.utility);
    if (best && worth <= most) continue;
    best = i;
    most = worth;
  }
  return best;
}

}  // namespace

Decision decide(const Situation& situation, const Memory& memory, const DecisionConfig& config) {
  const CostTree tree = grow_cost_tree(situation.grid, config.path, {situation.grid.cell_of(situation.robot.p_map)});
  Decision decision;
  if (config.method == Method::kTare) {
    decision.candidates = propose_tour(situation, tree, memory, config);
  } else {
    decision.candidates = propose(situation, tree, memory, config);
    reject_far_ones(decision.candidates, config.max_candidates);
  }
  const std::vector<Candidate*> open = open_ones(decision.candidates);
  add_information(situation, open);
  for (Candidate* candidate : open) {
    if (situation.graph == nullptr || situation.landmarks == nullptr) continue;
    if (std::string problem = add_gain(situation, config, *candidate); !problem.empty())
      decision.problem = std::move(problem);
  }
  for (Candidate* candidate : open) candidate->utility = utility(config.method, candidate->value, config.utility);
  decision.chosen = best_by(decision.candidates, config.method, memory, config);
  decision.by_mi_only = best_by(decision.candidates, Method::kMiOnly, memory, config);
  return decision;
}

}  // namespace lapis::planner
