#include "planner/core/decision/decision.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "planner/core/decision/explanation.hpp"
#include "planner/core/decision/first_turn.hpp"
#include "planner/core/hallucination/possible_loops.hpp"
#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {
namespace {

constexpr double kAway_m = 0.5;
constexpr double kAround_m = 2.0;      // radius around the target; frontiers are about that long
constexpr double kTurnStep_rad = 0.6;  // between views while the robot turns: half the field of view

ViewPath views_along(const Situation& s, const std::vector<Pose2>& path) {
  ViewPath views;
  for (const Pose2& pose : path) views.push_back(camera_at(s, pose));
  return views;
}

std::vector<Candidate*> open_ones(std::vector<Candidate>& candidates) {
  std::vector<Candidate*> open;
  for (Candidate& candidate : candidates) {
    if (candidate.is_open()) open.push_back(&candidate);
  }
  return open;
}

/// Poses of the views along the path, those of turns on the spot included; the robot's current view is not one of them.
std::vector<Pose2> poses_of(const Situation& s, const Candidate& candidate) {
  return with_turns(candidate.path, s.robot.yaw_rad, kTurnStep_rad);
}

/// The promise begins with the current view, which has more to tell while the robot continues to look. It is never
/// discounted: it is compared with what the map gains.
std::vector<PromisedView> promise_along(const Situation& s, const Candidate& candidate,
                                        const std::vector<double>& first_turn_rad) {
  std::vector<Pose2> poses{s.robot};
  for (const double heading_rad : first_turn_rad) poses.push_back({s.robot.p_map, heading_rad});
  const std::vector<Pose2> later = with_turns(candidate.path, poses.back().yaw_rad, kTurnStep_rad);
  poses.insert(poses.end(), later.begin(), later.end());
  const std::vector<double> nats = growing_information(s.field, s.view, views_along(s, poses));
  std::vector<PromisedView> promised;
  for (std::size_t i = 0; i < poses.size(); ++i) promised.push_back({poses[i], nats[i]});
  return promised;
}

/// The direction in which the path leads once it is kAway_m from the robot; its first corner may be a cell beside the
/// robot.
double first_heading(const Candidate& candidate) {
  const Eigen::Vector2d& robot_map = candidate.points.front();
  for (const Eigen::Vector2d& p_map : candidate.points) {
    const Eigen::Vector2d away = p_map - robot_map;
    if (away.norm() >= kAway_m) return std::atan2(away.y(), away.x());
  }
  return candidate.path.front().yaw_rad;
}

void add_information(const Situation& s, const Asks& asks, const std::vector<Candidate*>& open) {
  std::vector<ViewPath> paths;
  for (const Candidate* candidate : open) paths.push_back(views_along(s, poses_of(s, *candidate)));
  if (asks.path_information) {
    const auto nats = path_information(s.field, s.view, std::span<const ViewPath>(paths));
    for (std::size_t i = 0; i < open.size(); ++i) open[i]->value.path_information = nats[i];
  }
  if (asks.goal_information) {
    for (ViewPath& path : paths) path.erase(path.begin(), path.end() - 1);
    const auto nats = path_information(s.field, s.view, std::span<const ViewPath>(paths), Counting::kEveryRay);
    for (std::size_t i = 0; i < open.size(); ++i) open[i]->value.goal_information = nats[i];
  }
}

/// Share of the cells within kAround_m that are unknown.
double unknown_share(const PlanningGrid& grid, const Eigen::Vector2d& center_map) {
  const Cell center = grid.cell_of(center_map);
  const int reach = static_cast<int>(kAround_m / grid.resolution_m());
  int cells = 0, unknown = 0;
  for (Cell offset{0, -reach}; offset.y <= reach; ++offset.y) {
    for (offset.x = -reach; offset.x <= reach; ++offset.x) {
      if (squared_distance(offset, {}) > reach * reach) continue;
      ++cells;
      unknown += grid.state(center + offset) == mapping::kUnknown ? 1 : 0;
    }
  }
  return static_cast<double>(unknown) / cells;
}

std::vector<geometry::Pose> nodes_along(const Situation& s, const Candidate& candidate, double spacing_m) {
  std::vector<geometry::Pose> nodes = views_along(s, poses_along(candidate.points, spacing_m, candidate.goal.yaw_rad));
  if (nodes.size() > 1) nodes.erase(nodes.begin());  // the robot is already there
  return nodes;
}

// Adds what the pose graph would gain; returns what is wrong with the graph, or an empty string.
std::string add_gain(const Situation& s, const DecisionConfig& config, Candidate& candidate) {
  const auto nodes = nodes_along(s, candidate, config.node_spacing_m);
  const Hallucination path =
      hallucinate(*s.graph, *s.landmarks, s.field, s.view.config().camera, nodes, config.hallucination);
  const auto gain = expect_gain(*s.graph, path, config.sigma_limit_voxels * s.grid.resolution_m());
  if (const auto* error = std::get_if<GraphError>(&gain)) return error->message;
  const auto literal = literal_optimality(*s.graph, path);
  if (const auto* error = std::get_if<GraphError>(&literal)) return error->message;
  candidate.gain = std::get<ExpectedGain>(gain);
  for (const geometry::Pose& node : nodes) candidate.nodes_map.emplace_back(node.translation());
  for (const Place& place : path.places) {
    const geometry::Pose& keyframe = s.graph->keyframes[static_cast<std::size_t>(place.keyframe)].T_map_camera;
    candidate.loops.push_back(
        {candidate.nodes_map[static_cast<std::size_t>(place.node)], keyframe.translation(), place.probability});
  }
  candidate.value.loop_gain = candidate.gain.saturated_loop_gain;
  candidate.value.optimality = std::get<double>(literal);
  candidate.value.fixed_n_d_optimality =
      d_optimality(s.graph->factor.node_count(), s.graph->factor.log_trees() + candidate.gain.fixed_n_change);
  return "";
}

// The Fisher information of a surface's position is 1 / c^2 where the map alone limits it, and 1 / (c^2 + s^2) where
// the position of the camera has variance s^2, too. The variances of the views are interpolated between that of the
// robot and that of the path's end.
void discount_information(const Situation& s, double limit_m, Candidate& candidate) {
  const double robot = std::pow(position_sigma_m(*s.graph) / limit_m, 2);
  const double end = std::pow(candidate.gain.end_sigma_m / limit_m, 2);
  const auto last = static_cast<double>(candidate.path.size() - 1);
  double sum = 0.0;
  for (double i = 0.0; i <= last; i += 1.0) sum += 1.0 / (1.0 + std::lerp(robot, end, last > 0.0 ? i / last : 1.0));
  candidate.value.path_information *= sum / (last + 1.0);
  candidate.value.goal_information /= 1.0 + end;
}

/// Adds what survives of the path's views, and what its loops secure.
void add_worth(const Situation& s, const DecisionConfig& config, Candidate& candidate) {
  const auto nodes = nodes_along(s, candidate, config.node_spacing_m);
  const auto loops =
      possible_loops(*s.graph, *s.landmarks, s.field, s.view.config().camera, nodes, config.hallucination);
  candidate.value.secured_nats = s.worth->secured_nats(loops);
  const geometry::Pose* before = &s.graph->keyframes.back().T_map_camera;
  double path_m = 0.0, sum = 0.0;
  for (const geometry::Pose& node : nodes) {
    path_m += path_between(*before, node);
    before = &node;
    sum += s.worth->share_of_view(node.translation().head<2>(), node.linear().col(2), path_m);
  }
  candidate.value.surviving_share = sum / static_cast<double>(nodes.size());
}

/// Judges the candidates' worth, the most promising first, until none can be better than the best: no path secures more
/// than poses without errors would.
void add_worths(const Situation& s, const DecisionConfig& config, std::vector<Candidate*> open) {
  const double most_nats = s.worth->lost_nats();
  for (Candidate* candidate : open) candidate->value.secured_nats = most_nats;
  const Method& method = *config.method;
  std::stable_sort(open.begin(), open.end(),
                   [&](const Candidate* a, const Candidate* b) { return method.utility(*a) > method.utility(*b); });
  double best = 0.0;
  for (Candidate* candidate : open) {
    if (method.utility(*candidate) * config.keep_factor < best) {
      candidate->rejection = Rejection::kOutranked;
    } else {
      add_worth(s, config, *candidate);
      best = std::max(best, method.utility(*candidate));
    }
  }
}

std::optional<std::size_t> best_by(const std::vector<Candidate>& candidates, const Method& method, const Memory& memory,
                                   double keep_factor) {
  const double kept = method.keeps_goal() ? keep_factor : 1.0;
  std::optional<std::size_t> best;
  double most = 0.0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].is_open()) continue;
    const double bonus = is_current_goal(candidates[i], memory) ? kept : 1.0;
    const double worth = bonus * method.utility(candidates[i]);
    if (best && worth <= most) continue;
    best = i;
    most = worth;
  }
  return best;
}

/// Adds what the pose graph would gain by each candidate. If the graph cannot be judged, no candidate gets a gain: all
/// have the same D.
std::string add_gains(const Situation& s, const DecisionConfig& config, const std::vector<Candidate*>& open) {
  std::string problem;
  const bool has_graph = s.graph != nullptr && s.landmarks != nullptr;
  for (std::size_t i = 0; has_graph && problem.empty() && i < open.size(); ++i) problem = add_gain(s, config, *open[i]);
  const bool is_judged = has_graph && problem.empty();
  for (Candidate* candidate : open) {
    if (!is_judged) {
      candidate->gain = {};
      candidate->nodes_map.clear();
      candidate->loops.clear();
      candidate->value.loop_gain = 0.0;
      candidate->value.optimality = candidate->value.fixed_n_d_optimality = 1.0;
    } else if (config.information_discount_sigma_m > 0.0) {
      discount_information(s, config.information_discount_sigma_m, *candidate);
    }
  }
  return problem;
}

/// Why each frontier is not viewed: of the reasons of its paths, the one that is last in the enumeration.
std::map<std::uint32_t, Rejection> reasons_by_frontier(const std::vector<Candidate>& candidates) {
  std::map<std::uint32_t, Rejection> reasons;
  for (const Candidate& candidate : candidates) {
    Rejection& reason = reasons.try_emplace(candidate.frontier, candidate.rejection).first->second;
    reason = std::max(reason, candidate.rejection);
  }
  return reasons;
}

Leftover leftover_of(const Situation& s, const std::vector<Candidate>& candidates) {
  const double robot_width_m = 2.0 * s.grid.required_clearance_m();
  Leftover leftover;
  double left_m = 0.0, to_blame_m = 0.0;
  for (const auto& [id, reason] : reasons_by_frontier(candidates)) {
    const auto frontier = s.frontiers.frontiers().find(id);
    if (frontier == s.frontiers.frontiers().end()) continue;  // the candidate is not a view of a frontier
    const double length_m = frontier->second.length_m;
    leftover.length_m[reason] += length_m;
    left_m += length_m;
    to_blame_m += is_geometric(reason) || length_m < robot_width_m ? 0.0 : length_m;
  }
  leftover.share_to_blame = left_m > 0.0 ? to_blame_m / left_m : 0.0;
  return leftover;
}

/// Asks for the spectrum, too, where the information is discounted by the position's variance.
Asks with_discount(Asks asks, const DecisionConfig& config) {
  const bool is_discounted = config.information_discount_sigma_m > 0.0;
  if (is_discounted && (asks.path_information || asks.goal_information)) asks.spectrum = true;
  return asks;
}

/// Computes what the map and the pose graph would gain by each open candidate, as far as it is asked for. Returns what
/// is wrong with the graph; empty when nothing is.
std::string judge(const Situation& s, const DecisionConfig& config, const Asks& asks,
                  std::vector<Candidate>& candidates) {
  const std::vector<Candidate*> open = open_ones(candidates);
  if (asks.path_information || asks.goal_information) add_information(s, asks, open);
  if (asks.unknown_share) {
    for (Candidate* candidate : open) candidate->value.unknown_share = unknown_share(s.grid, candidate->target_map);
  }
  std::string problem = asks.spectrum ? add_gains(s, config, open) : "";
  if (asks.map_worth && s.worth != nullptr && s.graph != nullptr && s.landmarks != nullptr) {
    add_worths(s, config, open);
  }
  for (Candidate* candidate : open) candidate->utility = config.method->utility(*candidate);
  return problem;
}

/// Judges the proposed candidates and chooses among them.
Decision choose(const Situation& s, std::vector<Candidate> proposals, const Memory& memory,
                const DecisionConfig& config) {
  Decision decision;
  decision.candidates = std::move(proposals);
  decision.known = config.method->asks();
  for (const auto& other : config.compared_methods) decision.known = decision.known | other->asks();
  decision.known = with_discount(decision.known, config);
  decision.problem = judge(s, config, decision.known, decision.candidates);
  decision.chosen = best_by(decision.candidates, *config.method, memory, config.keep_factor);
  for (const auto& other : config.compared_methods)
    decision.by_compared_methods.push_back(best_by(decision.candidates, *other, memory, config.keep_factor));
  return decision;
}

}  // namespace

std::string Leftover::text() const {
  std::string text;
  for (const auto& [reason, metres] : length_m) {
    char number[32];
    std::snprintf(number, sizeof number, "%.1f m", metres);
    text += (text.empty() ? "" : ", ") + (number + (": " + text_of(reason)));
  }
  return text.empty() ? "" : "frontiers left: " + text;
}

Decision decide(const Situation& situation, const Memory& memory, const DecisionConfig& config) {
  const CostTree tree = grow_cost_tree(situation.grid, config.path, {situation.grid.cell_of(situation.robot.p_map)});
  const std::vector<Candidate> proposals = config.method->propose({situation, tree, memory, config});
  Decision decision = choose(situation, proposals, memory, config);
  if (decision.chosen) {
    const Candidate& chosen = decision.candidates[*decision.chosen];
    decision.first_turn_rad =
        first_turn(situation, first_heading(chosen), memory.turns_to, config.hallucination.covisibility);
    decision.explanation = explain(decision.candidates, *decision.chosen, config.method->asks());
    decision.promised = promise_along(situation, chosen, decision.first_turn_rad);
  } else {
    decision.leftover = leftover_of(situation, decision.candidates);
  }
  for (const InformationField& field : situation.compared_fields) {
    const Situation other{situation.grid,  situation.frontiers, field,          situation.view, situation.T_base_camera,
                          situation.graph, situation.landmarks, situation.robot};
    std::vector<Candidate> candidates = proposals;
    judge(other, config, with_discount(config.method->asks(), config), candidates);
    decision.by_compared_fields.push_back(best_by(candidates, *config.method, memory, config.keep_factor));
  }
  return decision;
}

}  // namespace lapis::planner
