#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "controller/core/local_map.hpp"
#include "controller/core/path_fan.hpp"

namespace lapis::controller {

/// What to drive now.
struct LocalPath {
  double heading_rad = 0.0;  ///< turn on the spot by so much first; 0: drive
  std::size_t group = 0;
  double curvature_per_m = 0.0;   ///< to drive with after that
  double free_length_m = 0.0;     ///< of the best path of the group
  std::vector<PlanarPose> poses;  ///< of that path in base_link, as far as it is free
};

/// Chooses among the groups of a fan, turned into several headings, the one whose free paths come nearest to a goal.
class LocalPlanner {
 public:
  explicit LocalPlanner(PathFan fan) : fan_(std::move(fan)) {}

  const PathFan& fan() const { return fan_; }
  /// The goal in base_link; `last` is what was chosen in the cycle before. Nothing when no free path leads nearer.
  /// Paths that come too near to unseen feet count less.
  std::optional<LocalPath> choose(const Surroundings& around, const Eigen::Vector2d& goal,
                                  const std::optional<LocalPath>& last) const;
  /// How far the robot can continue with this curvature [m].
  double free_length_m(std::span<const Eigen::Vector2d> obstacles, double curvature_per_m) const;

 private:
  struct Candidate {
    double score = 0.0;
    double heading_rad = 0.0;
    std::size_t path = 0;  ///< the best of its group
    std::size_t free_poses = 0;
  };
  void rate_groups(const Surroundings& around, const Eigen::Vector2d& goal, double heading_rad,
                   std::vector<Candidate>& candidates) const;
  LocalPath local_path_of(const Candidate& candidate) const;

  PathFan fan_;
};

}  // namespace lapis::controller
