#include "controller/core/local_planner.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

namespace lapis::controller {
namespace {

constexpr int kHeadings = 24;            // on the circle; the first is straight on
constexpr double kWidestGoal_rad = 1.3;  // from a heading: no path leads farther to the side
constexpr double kScale_m = 0.1;         // a path that misses the goal by this much more counts 1/e
constexpr double kTurnScale_rad = 1.0;   // so does turning on the spot by this much more
constexpr double kProgress =
    0.3;  // share of the distance to the goal: a path that brings the robot nearer by less is none
constexpr double kDoubt = 0.5;  // a path past what may stand there counts so much
constexpr double kFaith = 1.2;  // what was chosen before counts so much more, or two equal paths alternate
constexpr double kSameHeading_rad = 0.3;

struct Approach {
  double distance_m;
  std::size_t pose;
};

/// Where the free part of a path comes nearest to the goal.
Approach nearest_to(const Eigen::Vector2d& goal, const FanPath& path, std::size_t free_poses) {
  Approach best{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < free_poses; ++i) {
    const double squared = (path.poses[i].translation() - goal).squaredNorm();
    if (squared < best.distance_m) best = {squared, i};
  }
  best.distance_m = std::sqrt(best.distance_m);
  return best;
}

}  // namespace

std::optional<LocalPath> LocalPlanner::choose(const Surroundings& around, const Eigen::Vector2d& goal,
                                              const std::optional<LocalPath>& last) const {
  std::vector<Candidate> candidates;
  for (int i = 0; i < kHeadings; ++i) {
    const double heading = wrapped(2.0 * std::numbers::pi * i / kHeadings);
    if (std::abs(wrapped(bearing(goal) - heading)) > kWidestGoal_rad) continue;
    rate_groups(around, goal, heading, candidates);
  }
  for (Candidate& candidate : candidates) {
    if (!last) break;
    const bool is_same_turn = std::abs(candidate.heading_rad - last->heading_rad) < kSameHeading_rad;
    const bool is_same_group = fan_.paths()[candidate.path].group == last->group;
    // While it turns, its side counts; while it drives, its group.
    if (last->heading_rad != 0.0 ? is_same_turn : is_same_turn && is_same_group) candidate.score *= kFaith;
  }
  const auto best = std::max_element(candidates.begin(), candidates.end(),
                                     [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  if (best == candidates.end()) return std::nullopt;
  return local_path_of(*best);
}

/// Adds the groups that have a free path to the goal. A path that an obstacle cuts while it comes nearer does not
/// count, unless it is there already: it leads to the obstacle, not past it.
void LocalPlanner::rate_groups(const Surroundings& around, const Eigen::Vector2d& goal, double heading_rad,
                               std::vector<Candidate>& candidates) const {
  const auto free = fan_.free_poses(around.obstacles, heading_rad);
  const auto sure = fan_.free_poses(around.unseen_feet, heading_rad);
  const Eigen::Vector2d goal_heading = Eigen::Rotation2Dd(-heading_rad) * goal;
  const double turn_factor = std::exp(-std::abs(heading_rad) / kTurnScale_rad);
  std::vector<Candidate> of_group(fan_.groups());
  const double near_m = (1.0 - kProgress) * goal.norm();
  std::vector<double> nearest_m(fan_.groups(), near_m);
  for (std::size_t i = 0; i < fan_.paths().size(); ++i) {
    const FanPath& path = fan_.paths()[i];
    const Approach approach = nearest_to(goal_heading, path, free[i]);
    const bool is_cut = free[i] < path.poses.size() && approach.pose + 1U == free[i] && approach.distance_m > kScale_m;
    if (is_cut || approach.distance_m > near_m) continue;
    Candidate& candidate = of_group[path.group];
    candidate.score +=
        (approach.pose < sure[i] ? 1.0 : kDoubt) * turn_factor * std::exp(-approach.distance_m / kScale_m);
    if (approach.distance_m > nearest_m[path.group]) continue;
    nearest_m[path.group] = approach.distance_m;
    candidate.heading_rad = heading_rad;
    candidate.path = i;
    candidate.free_poses = free[i];
  }
  std::copy_if(of_group.begin(), of_group.end(), std::back_inserter(candidates),
               [](const Candidate& candidate) { return candidate.score > 0.0; });
}

LocalPath LocalPlanner::local_path_of(const Candidate& candidate) const {
  const FanPath& path = fan_.paths()[candidate.path];
  LocalPath local_path{candidate.heading_rad,
                       path.group,
                       path.curvature_per_m,
                       PathFan::kStep_m * static_cast<double>(candidate.free_poses - 1),
                       {}};
  const PlanarPose T_base_heading = planar_pose({0.0, 0.0}, candidate.heading_rad);
  for (std::size_t i = 0; i < candidate.free_poses; ++i) local_path.poses.push_back(T_base_heading * path.poses[i]);
  return local_path;
}

double LocalPlanner::free_length_m(std::span<const Eigen::Vector2d> obstacles, double curvature_per_m) const {
  const auto free = fan_.free_poses(obstacles, 0.0);
  return PathFan::kStep_m * static_cast<double>(free[fan_.path_along(curvature_per_m)] - 1);
}

}  // namespace lapis::controller
