#include "planner/core/tare/tare.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "planner/core/tare/short_tour.hpp"

namespace lapis::planner {
namespace {

constexpr int kHeadings = 8;
constexpr std::size_t kChoices = 3;  // number of best viewpoints of which one is drawn
constexpr int kTours = 10;
constexpr double kSureView = 0.9;             // share of the field of view; targets at its edge may be missed
constexpr double kSubSpacesPerHorizon = 5.0;  // number along an edge of the local area
constexpr std::size_t kMostSubSpaces = 30;    // largest number in the coarse tour
constexpr double kSameGoal_m = 0.5, kSameGoal_rad = 0.5;
constexpr double kForbidden_m = 1e6;

bool is_goal(const Pose2& pose, const std::optional<Pose2>& goal) {
  return goal && (goal->p_map - pose.p_map).norm() < kSameGoal_m &&
         turn_between(goal->yaw_rad, pose.yaw_rad) < kSameGoal_rad;
}

bool is_left_alone(const TourProblem& problem, Cell c) {
  const Eigen::Vector2d p = problem.grid.center_of(c);
  return why_left_alone(problem.left_alone, p, std::nullopt, problem.radius_m) != Rejection::kNone;
}

/// Why the target must not be viewed from there; kNone when it may be.
Rejection why_not_viewed(const TourProblem& problem, Cell from, Cell target) {
  const Eigen::Vector2d p = problem.grid.center_of(target), from_map = problem.grid.center_of(from);
  const Rejection why = why_left_alone(problem.left_alone, p, from_map, problem.radius_m);
  if (!is_failed_view(problem.failed_views, p, from_map, problem.radius_m)) return why;
  return std::max(why, Rejection::kFailedView);
}

/// A cell of a frontier that has to be covered.
struct Target {
  Cell cell;
  std::uint32_t frontier;
};

/// A viewpoint of the lattice, with the targets that it covers.
struct LocalView {
  TourStop stop;
  std::vector<std::size_t> covered;
};

/// Costs of paths between stops; the search from each stop is done once.
class PathCosts {
 public:
  explicit PathCosts(const TourProblem& problem) : problem_(problem) {}

  /// Costs [m] between nodes: node 0 is the robot, node i is stops[i - 1].
  Eigen::MatrixXd between(const std::vector<TourStop>& stops, double max_cost_m) {
    const auto count = static_cast<Eigen::Index>(stops.size());
    Eigen::MatrixXd cost = Eigen::MatrixXd::Zero(count + 1, count + 1);
    for (Eigen::Index b = 1; b <= count; ++b) {
      const Viewpoint& to = stops[static_cast<std::size_t>(b - 1)].viewpoint;
      cost(0, b) = cost(b, 0) = to.cost_m + turn_cost(problem_.robot, to.pose);
      for (Eigen::Index a = 1; a < b; ++a) {
        const Viewpoint& from = stops[static_cast<std::size_t>(a - 1)].viewpoint;
        const auto path_cost_m = tree(to.cell, max_cost_m).cost_m(from.cell);
        cost(a, b) = cost(b, a) = path_cost_m.value_or(from.cost_m + to.cost_m) + turn_cost(from.pose, to.pose);
      }
    }
    return cost;
  }

 private:
  double turn_cost(const Pose2& a, const Pose2& b) const {
    return problem_.turn_cost_m_per_rad * turn_between(a.yaw_rad, b.yaw_rad);
  }
  const CostTree& tree(Cell root, double max_cost_m) {
    const auto known = trees_.find(root);
    if (known != trees_.end()) return known->second;
    return trees_.emplace(root, grow_cost_tree(problem_.grid, problem_.path, {root, std::nullopt, max_cost_m}))
        .first->second;
  }

  const TourProblem& problem_;
  std::map<Cell, CostTree> trees_;
};

struct TourOrder {
  std::vector<TourStop> stops;
  double length_m = 0.0;
};

/// A short tour from the robot. The current goal stays the first stop unless another order is shorter by the keep
/// factor.
TourOrder order(const TourProblem& problem, PathCosts& costs, const std::vector<TourStop>& stops, bool ends_at_last,
                double max_cost_m) {
  if (stops.empty()) return {};
  const Eigen::MatrixXd cost = costs.between(stops, max_cost_m);
  std::vector<int> nodes = short_tour(cost, ends_at_last);
  const auto kept = std::find_if(stops.begin(), stops.end(),
                                 [&](const TourStop& stop) { return is_goal(stop.viewpoint.pose, problem.goal); });
  if (kept != stops.end()) {
    Eigen::MatrixXd kept_first = cost;
    for (Eigen::Index node = 1; node < cost.rows(); ++node) {
      if (node != kept - stops.begin() + 1) kept_first(0, node) = kept_first(node, 0) = kForbidden_m;
    }
    std::vector<int> other = short_tour(kept_first, ends_at_last);
    if (tour_length(cost, other) <= problem.keep_factor * tour_length(cost, nodes)) nodes = std::move(other);
  }
  TourOrder result{{}, tour_length(cost, nodes)};
  for (std::size_t i = 1; i < nodes.size(); ++i) result.stops.push_back(stops[static_cast<std::size_t>(nodes[i] - 1)]);
  return result;
}

std::vector<Target> targets_around(const TourProblem& problem, double reach_m) {
  std::vector<Target> targets;
  for (const auto& [id, frontier] : problem.frontiers.frontiers()) {
    for (const Cell& c : frontier.cells) {
      const Eigen::Vector2d offset = problem.grid.center_of(c) - problem.robot.p_map;
      if (offset.lpNorm<Eigen::Infinity>() <= reach_m && !is_left_alone(problem, c)) targets.push_back({c, id});
    }
  }
  return targets;
}

/// Targets that a camera in a cell covers, by heading; the nearest target comes first.
std::array<std::vector<std::size_t>, kHeadings> covered_from(const TourProblem& problem, const TareConfig& config,
                                                             const std::vector<Target>& targets, Cell from) {
  std::array<std::vector<std::size_t>, kHeadings> covered;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const Cell to = targets[i].cell;
    const double range_m = distance(from, to) * problem.grid.resolution_m();
    if (range_m < problem.viewpoints.min_distance_m || range_m > config.range_m) continue;
    if (!is_in_sight(problem.grid, from, to) || why_not_viewed(problem, from, to) != Rejection::kNone) continue;
    const double bearing = std::atan2(to.y - from.y, to.x - from.x);
    for (std::size_t k = 0; k < kHeadings; ++k) {
      const double heading = 2.0 * std::numbers::pi / kHeadings * static_cast<double>(k);
      if (turn_between(heading, bearing) <= 0.5 * kSureView * problem.fov_rad) covered[k].push_back(i);
    }
  }
  for (auto& of_heading : covered) {
    std::stable_sort(of_heading.begin(), of_heading.end(), [&](std::size_t a, std::size_t b) {
      return squared_distance(from, targets[a].cell) < squared_distance(from, targets[b].cell);
    });
  }
  return covered;
}

std::size_t least_reward(const TourProblem& problem, const TareConfig& config) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(config.min_reward_m / problem.grid.resolution_m() - 1e-9)));
}

/// Viewpoints of the local area. The lattice does not move with the robot, so that a viewpoint still exists while the
/// robot drives to it.
std::vector<LocalView> local_views(const TourProblem& problem, const TareConfig& config,
                                   const std::vector<Target>& targets) {
  const PlanningGrid& grid = problem.grid;
  const int step = std::max(1, static_cast<int>(std::lround(config.lattice_m / grid.resolution_m())));
  const Eigen::Vector2d corner = Eigen::Vector2d::Constant(config.horizon_m);
  const Cell low = grid.cell_of(problem.robot.p_map - corner), high = grid.cell_of(problem.robot.p_map + corner);
  std::vector<LocalView> views;
  for (Cell c = low; c.y <= high.y; ++c.y) {
    for (c.x = low.x; c.x <= high.x; ++c.x) {
      if (c.x % step != 0 || c.y % step != 0 || !grid.is_traversable(c)) continue;
      const auto cost_m = problem.paths.cost_m(c);
      if (!cost_m || *cost_m > 2.0 * config.horizon_m) continue;
      auto covered = covered_from(problem, config, targets, c);
      for (std::size_t k = 0; k < kHeadings; ++k) {
        if (covered[k].size() < least_reward(problem, config)) continue;
        const Target& nearest = targets[covered[k].front()];
        const double yaw =
            std::remainder(2.0 * std::numbers::pi / kHeadings * static_cast<double>(k), 2.0 * std::numbers::pi);
        views.push_back(
            {{nearest.frontier, {c, {grid.center_of(c), yaw}, nearest.cell, *cost_m}}, std::move(covered[k])});
      }
    }
  }
  return views;
}

/// Draws viewpoints until each of the others would cover fewer than `least` further targets.
class RandomChoice {
 public:
  RandomChoice(const std::vector<LocalView>& views, std::size_t targets, std::size_t least)
      : views_(views), least_(least), is_covered_(targets, false) {}

  std::vector<TourStop> draw(const std::optional<Pose2>& goal, std::mt19937_64& engine) {
    const auto kept = std::find_if(views_.begin(), views_.end(),
                                   [&](const LocalView& v) { return is_goal(v.stop.viewpoint.pose, goal); });
    if (kept != views_.end()) take(*kept);
    for (auto best = best_ones(); !best.empty(); best = best_ones()) take(*best[engine() % best.size()].second);
    return std::move(stops_);
  }

 private:
  using Ranked = std::pair<std::size_t, const LocalView*>;  // number of further targets that it would cover, viewpoint

  std::vector<Ranked> best_ones() const {
    std::vector<Ranked> best;
    for (const LocalView& view : views_) {
      const auto gain = static_cast<std::size_t>(
          std::count_if(view.covered.begin(), view.covered.end(), [&](std::size_t i) { return !is_covered_[i]; }));
      if (gain < least_ || (best.size() == kChoices && gain <= best.back().first)) continue;
      const auto place = std::find_if(best.begin(), best.end(), [&](const Ranked& r) { return gain > r.first; });
      best.insert(place, {gain, &view});
      best.resize(std::min(best.size(), kChoices));
    }
    return best;
  }
  void take(const LocalView& view) {
    for (const std::size_t i : view.covered) is_covered_[i] = true;
    stops_.push_back(view.stop);
  }

  const std::vector<LocalView>& views_;
  std::size_t least_;
  std::vector<bool> is_covered_;
  std::vector<TourStop> stops_;
};

/// The best viewpoint of a frontier: the current goal if it is one, otherwise the cheapest.
std::optional<TourStop> stop_at(const TourProblem& problem, const Frontier& frontier, Tour& tour) {
  const ViewpointResult found = sample_viewpoints(problem.grid, problem.paths, frontier, problem.viewpoints);
  std::optional<TourStop> best;
  const auto rank = [&](const Viewpoint& v) { return is_goal(v.pose, problem.goal) ? 0.0 : v.cost_m; };
  Rejection lack = found.rejection;
  for (const Viewpoint& viewpoint : found.viewpoints) {
    const Rejection why = why_not_viewed(problem, viewpoint.cell, viewpoint.target);
    lack = std::max(lack, why);
    if (why != Rejection::kNone) continue;
    if (!best || rank(viewpoint) < rank(best->viewpoint)) best = TourStop{frontier.id, viewpoint};
  }
  if (!best) tour.missed.emplace_back(frontier.id, lack);
  return best;
}

/// One stop in each sub-space with frontiers that no local viewpoint covers, the cheapest first.
std::vector<TourStop> sub_spaces(const TourProblem& problem, const TareConfig& config,
                                 const std::vector<LocalView>& views, const std::vector<Target>& targets, Tour& tour) {
  std::set<std::uint32_t> is_local;
  for (const LocalView& view : views)
    for (const std::size_t i : view.covered) is_local.insert(targets[i].frontier);
  const double edge_m = 2.0 * config.horizon_m / kSubSpacesPerHorizon;
  std::map<Cell, TourStop> by_space;
  for (const auto& [id, frontier] : problem.frontiers.frontiers()) {
    if (is_local.contains(id)) continue;
    const auto stop = stop_at(problem, frontier, tour);
    if (!stop) continue;
    const Eigen::Vector2d p = problem.grid.center_of(stop->viewpoint.target) / edge_m;
    const Cell space{static_cast<std::int32_t>(std::floor(p.x())), static_cast<std::int32_t>(std::floor(p.y()))};
    const auto [known, is_new] = by_space.try_emplace(space, *stop);
    if (is_new || is_goal(known->second.viewpoint.pose, problem.goal)) continue;
    const bool is_better =
        is_goal(stop->viewpoint.pose, problem.goal) || stop->viewpoint.cost_m < known->second.viewpoint.cost_m;
    if (is_better) known->second = *stop;
  }
  std::vector<TourStop> stops;
  for (const auto& entry : by_space) stops.push_back(entry.second);
  std::stable_sort(stops.begin(), stops.end(),
                   [](const TourStop& a, const TourStop& b) { return a.viewpoint.cost_m < b.viewpoint.cost_m; });
  for (std::size_t i = kMostSubSpaces; i < stops.size(); ++i)
    tour.missed.emplace_back(stops[i].frontier, Rejection::kFarSpace);
  stops.resize(std::min(stops.size(), kMostSubSpaces));
  return stops;
}

/// Names the frontiers that are covered from a stop at another one, or that share a sub-space with another stop.
void name_the_rest(const TourProblem& problem, Tour& tour) {
  std::set<std::uint32_t> named;
  for (const TourStop& stop : tour.stops) named.insert(stop.frontier);
  for (const auto& entry : tour.missed) named.insert(entry.first);
  for (const auto& entry : problem.frontiers.frontiers()) {
    if (!named.contains(entry.first)) tour.missed.emplace_back(entry.first, Rejection::kBesideStop);
  }
}

}  // namespace

Tour plan_tour(const TourProblem& problem, const TareConfig& config) {
  const std::vector<Target> targets = targets_around(problem, config.horizon_m + config.range_m);
  const std::vector<LocalView> views = local_views(problem, config, targets);
  Tour tour;
  PathCosts costs(problem);
  const TourOrder global = order(problem, costs, sub_spaces(problem, config, views, targets, tour), false,
                                 std::numeric_limits<double>::infinity());
  std::mt19937_64 engine(static_cast<std::uint64_t>(config.seed));
  std::optional<TourOrder> local;
  for (int i = 0; i < kTours && !views.empty(); ++i) {
    RandomChoice choice(views, targets.size(), least_reward(problem, config));
    std::vector<TourStop> stops = choice.draw(problem.goal, engine);
    if (!global.stops.empty()) stops.push_back(global.stops.front());
    TourOrder order_of = order(problem, costs, stops, !global.stops.empty(), 2.0 * config.horizon_m);
    if (!local || order_of.length_m < local->length_m) local = std::move(order_of);
  }
  if (local) tour.stops = std::move(local->stops);
  if (local && !global.stops.empty()) tour.stops.pop_back();  // the global stop at which the local tour ends
  tour.local_stops = tour.stops.size();
  tour.stops.insert(tour.stops.end(), global.stops.begin(), global.stops.end());
  name_the_rest(problem, tour);
  return tour;
}

}  // namespace lapis::planner
