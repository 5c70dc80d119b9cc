#include "controller/core/local_planner.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

namespace lapis::controller {
namespace {

constexpr int kHeadings = 24;            // on the full circle; the first is straight ahead
constexpr double kWidestGoal_rad = 1.3;  // off a heading: no path leads farther to the side
constexpr double kScale_m = 0.1;         // the weight of a path falls to 1/e per this distance from the goal
constexpr double kTurnScale_rad = 1.0;   // and per this angle of a turn on the spot
constexpr double kProgress = 0.3;        // a path must shorten the distance to the goal by at least this share
constexpr double kDoubt = 0.5;           // weight of a path that passes unseen feet
constexpr double kFaith = 1.2;           // weight of the previous choice, so that two equal paths do not alternate
constexpr double kSameHeading_rad = 0.3;

struct Approach {
  double distance_m;
  std::size_t pose;
};

/// The pose at which the free part of a path is nearest to the goal.
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
    // During a turn the heading must be the same; while driving, the group, too.
    if (last->heading_rad != 0.0 ? is_same_turn : is_same_turn && is_same_group) candidate.score *= kFaith;
  }
  const auto best = std::max_element(candidates.begin(), candidates.end(),
                                     [](const Candidate& a, const Candidate& b) { return a.score < b.score; });
  if (best == candidates.end()) return std::nullopt;
  return local_path_of(*best);
}

/// Adds the groups that have a free path towards the goal. A path that an obstacle cuts while it still approaches the
/// goal does not count, unless it is already there: it leads to the obstacle, not past it.
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
