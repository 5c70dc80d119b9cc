#include "planner/core/decision/proposals.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "planner/core/decision/gap_views.hpp"
#include "planner/core/space/alternative_paths.hpp"
#include "planner/core/space/line.hpp"
#include "planner/core/space/path_planner.hpp"

namespace lapis::planner {
namespace {

constexpr double kSameGoal_m = 0.5;       // goals nearer to each other are one
constexpr std::size_t kMostRevisits = 5;  // of a decision, the nearest
constexpr std::size_t kMostTracked = 5;   // of a decision, the newest
constexpr double kPass_m = 0.75;          // path past an old place, in its direction
constexpr double kSameHeading_rad = 0.5;
constexpr double kLikely = 0.5;  // probability of a loop closure at the place itself

Candidate rejected(const Frontier& frontier, Rejection reason) {
  Candidate candidate;
  candidate.frontier = frontier.id;
  candidate.goal.p_map = candidate.target_map = frontier.centroid_map;
  candidate.rejection = reason;
  return candidate;
}

// Turning at both ends of a path; corners in between are driven through.
double turning(const Pose2& robot, const std::vector<Pose2>& path) {
  if (path.size() < 2) return turn_between(robot.yaw_rad, path.back().yaw_rad);
  return turn_between(robot.yaw_rad, path.front().yaw_rad) +
         turn_between(path[path.size() - 2].yaw_rad, path.back().yaw_rad);
}

void set_path(const Situation& s, const DecisionConfig& config, const Path& path, Candidate& candidate) {
  candidate.points = points_of(s.grid, path);
  candidate.points.front() = s.robot.p_map;
  candidate.path = poses_along(candidate.points, config.view_spacing_m, candidate.goal.yaw_rad);
  candidate.value.cost_m = path.length_m + config.turn_cost_m_per_rad * turning(s.robot, candidate.path);
}

Candidate candidate_at(const Situation& s, const CostTree& tree, std::uint32_t frontier, const Viewpoint& viewpoint,
                       const DecisionConfig& config) {
  Candidate candidate;
  candidate.frontier = frontier;
  candidate.goal = viewpoint.pose;
  candidate.target_map = s.grid.center_of(viewpoint.target);
  set_path(s, config, straightened(s.grid, config.path, tree.path_to(viewpoint.cell)), candidate);
  return candidate;
}

bool is_any_open(const std::vector<Candidate>& candidates) {
  return std::any_of(candidates.begin(), candidates.end(), [](const Candidate& c) { return c.is_open(); });
}

/// Frontiers that cannot be seen from anywhere, as the map is.
std::set<std::uint32_t> hidden_ones(const std::vector<Candidate>& candidates) {
  std::set<std::uint32_t> hidden;
  for (const Candidate& candidate : candidates) {
    if (candidate.rejection == Rejection::kHidden) hidden.insert(candidate.frontier);
  }
  return hidden;
}

/// @param hidden when nothing else is left, a frontier that is long enough need not be in sight: closer looks. Those
/// of a hidden one may fail, it is hidden then.
std::vector<Candidate> propose_frontiers(const Situation& s, const CostTree& tree, const Memory& memory,
                                         const DecisionConfig& config,
                                         const std::optional<std::set<std::uint32_t>>& hidden = std::nullopt) {
  std::vector<Candidate> candidates;
  for (const auto& entry : s.frontiers.frontiers()) {
    const Frontier& frontier = entry.second;
    const bool is_room = frontier.length_m >= config.closer_look_length_m;
    const Sight sight = hidden && is_room ? Sight::kNotNeeded : Sight::kNeeded;
    const bool is_hidden = hidden && hidden->contains(frontier.id);
    const ViewpointResult found = sample_viewpoints(s.grid, tree, frontier, config.viewpoints, sight);
    if (found.viewpoints.empty()) candidates.push_back(rejected(frontier, found.rejection));
    for (const Viewpoint& viewpoint : found.viewpoints) {
      Candidate& candidate = candidates.emplace_back(candidate_at(s, tree, frontier.id, viewpoint, config));
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

/// By odometry alone the robot goes no farther than it may drift.
void reject_unsure_ones(const std::optional<Adrift>& adrift, std::vector<Candidate>& candidates) {
  if (!adrift) return;
  for (Candidate& candidate : candidates) {
    const bool is_sure = adrift->sigma_m + adrift->growth * candidate.value.cost_m <= adrift->budget_m;  // never of NaN
    if (candidate.is_open() && !is_sure) candidate.rejection = Rejection::kUnsure;
  }
}

/// Where slam tracked, it may again.
void add_tracked_places(const Situation& s, const CostTree& tree, const Memory& memory, const DecisionConfig& config,
                        std::vector<Candidate>& candidates) {
  if (!memory.adrift) return;
  std::size_t added = 0;
  for (const Pose2& pose : memory.adrift->tracked) {
    const Cell cell = s.grid.cell_of(pose.p_map);
    if (!s.grid.is_traversable(cell) || !tree.cost_m(cell)) continue;
    const Viewpoint viewpoint{cell, {s.grid.center_of(cell), pose.yaw_rad}, cell, 0.0};
    candidates.emplace_back(candidate_at(s, tree, 0, viewpoint, config)).kind = CandidateKind::kTracked;
    if (++added == kMostTracked) return;
  }
}

void add_gap_views(const Situation& s, const CostTree& tree, const Memory& memory, const DecisionConfig& config,
                   std::vector<Candidate>& candidates) {
  if (!memory.looks_at_gaps || config.gaps.least_nats <= 0.0) return;
  for (const Viewpoint& view : gap_views(s, tree, memory, config.gaps))
    candidates.emplace_back(candidate_at(s, tree, 0, view, config)).kind = CandidateKind::kGap;
}

// The stops of TARE's tour; as many of the first ones as may be looked at.
std::vector<Candidate> propose_tour(const Situation& s, const CostTree& tree, const Memory& memory,
                                    const DecisionConfig& config) {
  const geometry::PinholeCamera& camera = s.view.config().camera;
  const double fov_rad = 2.0 * std::atan(0.5 * camera.width / camera.fx);
  const Tour tour = plan_tour(
      {s.grid, s.frontiers, tree, s.robot, fov_rad, config.path, config.viewpoints, config.turn_cost_m_per_rad,
       memory.left_alone, memory.failed_views, memory.radius_m, memory.goal, config.keep_factor},
      config.tare);
  std::vector<Candidate> candidates;
  for (const TourStop& stop : tour.stops) {
    Candidate& candidate = candidates.emplace_back(candidate_at(s, tree, stop.frontier, stop.viewpoint, config));
    candidate.value.tour_place = static_cast<int>(candidates.size());
    if (candidate.value.tour_place > config.max_candidates) candidate.rejection = Rejection::kOutranked;
  }
  for (const auto& [id, reason] : tour.missed) candidates.push_back(rejected(s.frontiers.frontiers().at(id), reason));
  return candidates;
}

// Keeps what is being driven to and those with the shortest paths, but of every frontier the nearest one before the
// second of any.
void reject_far_ones(std::vector<Candidate>& candidates, const Memory& memory, int most) {
  std::vector<std::pair<int, double>> rank(candidates.size());  // place within the frontier, cost
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
    if (is_current_goal(candidates[i], memory)) rank[i] = {-1, 0.0};
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank[a] < rank[b]; });
  for (auto k = static_cast<std::size_t>(most); k < order.size(); ++k)
    candidates[order[k]].rejection = Rejection::kOutranked;
}

// As a tour: what is left when TARE has no stop any more.
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

// Where the robot stood when it made an old key-frame that shares many landmarks with others.
struct OldPlace {
  Pose2 pose;
  Cell cell;
};

OldPlace place_of(const Situation& s, const Keyframe& keyframe) {
  const geometry::Pose T_map_base = keyframe.T_map_camera * s.T_base_camera.inverse();
  const Eigen::Vector3d forward = T_map_base.linear().col(0);
  const Eigen::Vector2d p = T_map_base.translation().head<2>();
  return {{p, std::atan2(forward.y(), forward.x())}, s.grid.cell_of(p)};
}

// That can be reached; the one with the most such landmarks first, others not beside it.
std::vector<OldPlace> old_places(const Situation& s, const CostTree& tree, const HallucinationConfig& config) {
  std::vector<std::pair<int, int>> ranked;  // less landmarks, node
  for (int node = 0; node < s.graph->factor.node_count(); ++node) {
    const int landmarks = s.landmarks->shared_landmarks(node);
    const bool is_old = s.graph->path_from_newest_m[static_cast<std::size_t>(node)] >= config.min_loop_path_m;
    if (is_old && loop_probability(landmarks, config) >= kLikely) ranked.emplace_back(-landmarks, node);
  }
  std::sort(ranked.begin(), ranked.end());
  std::vector<OldPlace> places;
  for (const auto& entry : ranked) {
    const OldPlace place = place_of(s, s.graph->keyframes[static_cast<std::size_t>(entry.second)]);
    const bool is_new = std::none_of(places.begin(), places.end(), [&](const OldPlace& other) {
      return (other.pose.p_map - place.pose.p_map).norm() < config.place_radius_m;
    });
    if (is_new && s.grid.is_traversable(place.cell) && tree.cost_m(place.cell)) places.push_back(place);
  }
  return places;
}

bool passes(const std::vector<Pose2>& path, const Pose2& pose, double apart_m) {
  return std::any_of(path.begin(), path.end(), [&](const Pose2& on_path) {
    return (on_path.p_map - pose.p_map).norm() < apart_m &&
           turn_between(on_path.yaw_rad, pose.yaw_rad) < kSameHeading_rad;
  });
}

bool is_open_line(const PlanningGrid& grid, Cell from, Cell to) {
  return walk_line(from, to, [&](Cell c, double) { return grid.is_traversable(c); });
}

/// The path to a candidate's goal past the first old place that is not too far off: through it and on in its direction,
/// so that the camera sees what the key-frame saw.
std::optional<Path> path_past(const Situation& s, const CostTree& tree, const std::vector<OldPlace>& places,
                              const DecisionConfig& config, const Candidate& candidate, double direct_m) {
  if (places.empty()) return std::nullopt;
  const CostTree from_goal = grow_cost_tree(s.grid, config.path, {s.grid.cell_of(candidate.goal.p_map)});
  for (const OldPlace& place : places) {
    if (passes(candidate.path, place.pose, config.path.min_apart_m)) continue;
    const Eigen::Vector2d heading(std::cos(place.pose.yaw_rad), std::sin(place.pose.yaw_rad));
    const Cell beyond = s.grid.cell_of(place.pose.p_map + kPass_m * heading);
    if (!is_open_line(s.grid, place.cell, beyond) || !from_goal.cost_m(beyond)) continue;
    Path path = straightened(s.grid, config.path, tree.path_to(place.cell));
    std::vector<Cell> back = from_goal.path_to(beyond);
    std::reverse(back.begin(), back.end());
    const Path rest = straightened(s.grid, config.path, back);
    path.length_m += distance(place.cell, beyond) * s.grid.resolution_m() + rest.length_m;
    if (path.length_m > config.path.max_detour * direct_m) continue;
    path.cells.insert(path.cells.end(), rest.cells.begin(), rest.cells.end());
    return path;
  }
  return std::nullopt;
}

/// Other paths to a candidate's goal: around other obstacles, then past an old place.
void add_alternatives(const Situation& s, const CostTree& tree, const std::vector<OldPlace>& places,
                      const DecisionConfig& config, const Candidate& candidate, std::vector<Candidate>& all) {
  const Cell from = s.grid.cell_of(s.robot.p_map), to = s.grid.cell_of(candidate.goal.p_map);
  std::vector<Path> paths = find_alternatives(s.grid, config.path, from, to, 1 + config.alternatives);
  if (paths.empty()) return;
  const double direct_m = paths.front().length_m;
  paths.erase(paths.begin());
  if (paths.size() < static_cast<std::size_t>(config.alternatives)) {
    if (auto past = path_past(s, tree, places, config, candidate, direct_m)) paths.push_back(*std::move(past));
  }
  for (const Path& path : paths) {
    Candidate& other = all.emplace_back(candidate);
    other.kind = CandidateKind::kAlternative;
    set_path(s, config, path, other);
  }
}

/// To the nearest goal of every frontier that is still open.
void add_alternatives(const Situation& s, const CostTree& tree, const std::vector<OldPlace>& places,
                      const DecisionConfig& config, std::vector<Candidate>& candidates) {
  std::map<std::uint32_t, std::size_t> nearest;  // by frontier
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].is_open() || candidates[i].frontier == 0) continue;
    const auto [known, is_new] = nearest.try_emplace(candidates[i].frontier, i);
    if (!is_new && candidates[i].value.cost_m < candidates[known->second].value.cost_m) known->second = i;
  }
  std::vector<Candidate> others;
  for (const auto& entry : nearest) add_alternatives(s, tree, places, config, candidates[entry.second], others);
  candidates.insert(candidates.end(), others.begin(), others.end());
}

void add_revisits(const Situation& s, const CostTree& tree, std::vector<OldPlace> places, const Memory& memory,
                  const DecisionConfig& config, std::vector<Candidate>& candidates) {
  std::stable_sort(places.begin(), places.end(),
                   [&](const OldPlace& a, const OldPlace& b) { return *tree.cost_m(a.cell) < *tree.cost_m(b.cell); });
  places.resize(std::min(places.size(), kMostRevisits));
  for (const OldPlace& place : places) {
    const Viewpoint viewpoint{place.cell, {s.grid.center_of(place.cell), place.pose.yaw_rad}, place.cell, 0.0};
    Candidate& candidate = candidates.emplace_back(candidate_at(s, tree, 0, viewpoint, config));
    candidate.kind = CandidateKind::kRevisit;
    candidate.rejection = why_left_alone(memory.old_places, candidate.target_map, std::nullopt, memory.radius_m);
  }
}

}  // namespace

bool is_current_goal(const Candidate& candidate, const Memory& memory) {
  return memory.goal && (memory.goal->p_map - candidate.goal.p_map).norm() < kSameGoal_m;
}

std::vector<Candidate> propose(const Situation& s, const CostTree& tree, const Memory& memory,
                               const DecisionConfig& config) {
  const bool is_tour = config.method == Method::kTare;
  std::vector<Candidate> candidates =
      is_tour ? propose_tour(s, tree, memory, config) : propose_frontiers(s, tree, memory, config);
  reject_unsure_ones(memory.adrift, candidates);
  if (is_tour && is_any_open(candidates)) return candidates;
  if (!is_any_open(candidates)) {
    candidates = propose_frontiers(s, tree, memory, config, hidden_ones(candidates));
    reject_unsure_ones(memory.adrift, candidates);
  }
  if (!is_any_open(candidates)) {
    add_gap_views(s, tree, memory, config, candidates);
    reject_unsure_ones(memory.adrift, candidates);
  }
  if (!is_any_open(candidates)) add_tracked_places(s, tree, memory, config, candidates);
  reject_far_ones(candidates, memory, config.max_candidates);
  if (is_tour) return nearest_first(std::move(candidates));
  const bool is_driven_back = memory.adrift && memory.adrift->sigma_m > memory.adrift->budget_m;
  const bool may_revisit = config.revisit_sigma_m > 0.0 && counts_loops(config.method) && !is_driven_back;
  if (config.alternatives == 0 && !may_revisit) return candidates;
  std::vector<OldPlace> places;
  if (s.graph != nullptr && s.landmarks != nullptr) places = old_places(s, tree, config.hallucination);
  if (config.alternatives > 0) add_alternatives(s, tree, places, config, candidates);
  if (may_revisit && !places.empty() && position_sigma_m(*s.graph) > config.revisit_sigma_m)
    add_revisits(s, tree, std::move(places), memory, config, candidates);
  return candidates;
}

}  // namespace lapis::planner
