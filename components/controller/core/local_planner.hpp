#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "controller/core/local_map.hpp"
#include "controller/core/path_fan.hpp"

namespace lapis::controller {

/// The path to drive now.
struct LocalPath {
  double heading_rad = 0.0;  ///< first turn on the spot by this angle; 0: drive
  std::size_t group = 0;
  double curvature_per_m = 0.0;   ///< curvature to drive with after that, to the left
  double free_length_m = 0.0;     ///< free length of the best path of the group
  std::vector<PlanarPose> poses;  ///< free poses of that path in base_link
};

/// Rotates a fan of paths to several headings, and chooses the group whose free paths come nearest to a goal.
class LocalPlanner {
 public:
  explicit LocalPlanner(PathFan fan) : fan_(std::move(fan)) {}

  const PathFan& fan() const { return fan_; }
  /// Chooses a path to `goal`, a point in base_link; `last` is the choice of the previous cycle. Returns nothing when
  /// no free path leads nearer. Paths that come too near to unseen feet count less.
  std::optional<LocalPath> choose(const Surroundings& around, const Eigen::Vector2d& goal,
                                  const std::optional<LocalPath>& last) const;
  /// Distance that the robot can drive on with this curvature [m].
  double free_length_m(std::span<const Eigen::Vector2d> obstacles, double curvature_per_m) const;

 private:
  struct Candidate {
    double score = 0.0;
    double heading_rad = 0.0;
    std::size_t path = 0;  ///< the best path of the group
    std::size_t free_poses = 0;
  };
  void rate_groups(const Surroundings& around, const Eigen::Vector2d& goal, double heading_rad,
                   std::vector<Candidate>& candidates) const;
  LocalPath local_path_of(const Candidate& candidate) const;

  PathFan fan_;
};

}  // namespace lapis::controller
