#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/config/schema.hpp"
#include "controller/core/planar.hpp"

namespace lapis::controller {

struct FanConfig {
  double length_m = 1.5;             ///< length of a path
  double max_curvature_per_m = 2.5;  ///< curvature of the tightest path
  int groups = 19;                   ///< number of curvatures at the start; odd
  int branches = 7;                  ///< number of curvatures after half of a path; odd
  double max_bearing_rad = 1.05;     ///< a path ends where its bearing exceeds this to either side
  double margin_m = 0.05;            ///< clearance between the robot's disc and obstacles
};

template <class Field>
void describe(Field& field, FanConfig& c) {
  field("length_m", c.length_m, config::in_range(0.5, 5.0),
        "length of the paths of the fan, among which the controller chooses [m]");
  field("max_curvature_per_m", c.max_curvature_per_m, config::in_range(0.1, 10.0),
        "curvature of the tightest paths of the fan [1/m]");
  field("groups", c.groups, config::in_range(3, 99),
        "number of different curvatures of the first half of the fan's paths; odd");
  field("branches", c.branches, config::in_range(1, 99),
        "number of different curvatures of the second half of the fan's paths; odd");
  field("max_bearing_rad", c.max_bearing_rad, config::in_range(0.1, 3.0),
        "largest bearing of a point of the fan, to either side of the robot's heading; paths end where they "
        "exceed it [rad]");
  field("margin_m", c.margin_m, config::in_range(0.0, 1.0),
        "clearance between the robot's disc and obstacles from 0.4 m along a path on; it grows from half of this "
        "at the start [m]");
}

/// A path of the fan, in the frame of base_link at the beginning of the path.
struct FanPath {
  std::size_t group = 0;
  double curvature_per_m = 0.0;   ///< at the start, to the left
  double later_per_m = 0.0;       ///< curvature of the second half
  std::vector<PlanarPose> poses;  ///< PathFan::kStep_m apart; the first is the robot's pose
};

/// Paths that the robot may drive, and for every cell around it the distance that it can drive on each path when an
/// obstacle is in that cell. This table is computed once, so that a cycle only looks it up [Zhang, Hu, Chadha, Singh,
/// "FALCO", J. Field Robotics 2020]. A path consists of two arcs; paths with the same first arc form a group.
class PathFan {
 public:
  static constexpr double kStep_m = 0.05;     ///< between poses of a path; also the edge of a cell
  static constexpr double kRamp_m = 0.4;      ///< distance along a path from which the whole margin is required
  static constexpr double kLeastShare = 0.5;  ///< share of the margin at the beginning: points and cells are 5 cm wide
  static constexpr double kNearer_m = 0.01;

  /// Throws std::runtime_error naming the value that is out of range.
  PathFan(const FanConfig& config, double radius_m);

  std::size_t groups() const { return groups_; }
  const std::vector<FanPath>& paths() const { return paths_; }
  /// Distance from the robot beyond which obstacles have no effect [m].
  double reach_m() const { return reach_m_; }
  /// Number of free poses of every path when the robot first turns by `heading_rad`; `obstacles` are points in
  /// base_link. A point blocks a pose when it is nearer than radius plus margin. The margin grows from kLeastShare over
  /// the first kRamp_m, and a point that is already too near only blocks poses that are still nearer to it, so that the
  /// robot can drive away.
  std::vector<std::uint8_t> free_poses(std::span<const Eigen::Vector2d> obstacles, double heading_rad) const;
  /// Index of the path whose curvature is nearest to this one: first compared at the start, then in the second half.
  std::size_t path_along(double curvature_per_m) const;

 private:
  void make_paths(const FanConfig& config);
  void make_table(const FanConfig& config, double radius_m);
  std::uint8_t free_poses(const FanPath& path, const Eigen::Vector2d& obstacle, const FanConfig& config,
                          double radius_m) const;
  const std::uint8_t* cell(const Eigen::Vector2d& p) const;

  std::size_t groups_;
  std::vector<FanPath> paths_;
  std::vector<std::uint8_t> lengths_;  // number of poses of each path
  double reach_m_;
  int cells_per_side_;
  std::vector<std::uint8_t> table_;  // for each cell, the number of free poses of every path
};

}  // namespace lapis::controller
