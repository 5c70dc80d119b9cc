#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/robot/robot.hpp"
#include "simulator/core/robot/tour.hpp"

namespace lapis::simulator {

/// Drives a tour by regulated pure pursuit [Coulter, CMU-RI-TR-92-01; Macenski et al., Autonomous Robots 2023]: it
/// steers along the arc to a point of the path some distance ahead, turns on the spot towards a point that is far off
/// its heading, and slows down in bends, near obstacles, and before it stops.
class TourFollower {
 public:
  /// @param map must outlive the follower.
  TourFollower(const NavMap& map, Tour tour, const TourConfig& config);

  /// Command for the robot; to be called regularly (10 Hz or more). It is a standstill once the tour is finished.
  DriveCommand command(const RobotState& robot);
  bool is_finished() const { return leg_ == tour_.legs.size(); }
  /// Index of the leg (and waypoint) that is driven now; the number of legs once finished.
  std::size_t leg() const { return leg_; }
  /// One line that names the waypoint when the robot has not come nearer to it for a long time; else empty.
  std::string stalled() const;

 private:
  struct Mark {
    time::Time stamp;
    std::size_t leg = 0;
    double progress_m = 0.0;
  };
  DriveCommand next_command(const Eigen::Vector2d& position, double yaw_rad);
  void watch(const RobotState& robot);
  bool is_at_end() const;
  void begin_leg(std::size_t leg);
  DriveCommand pursue(const Eigen::Vector2d& position, double yaw_rad);
  Eigen::Vector2d target(const Eigen::Vector2d& position) const;
  bool is_clear(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;
  void track(const Eigen::Vector2d& position);
  Eigen::Vector2d point_at(double along_m) const;

  const NavMap* map_;
  Tour tour_;
  TourConfig config_;
  std::size_t leg_ = 0;
  std::vector<double> along_m_;  ///< distance along the leg's path, of each of its points
  double progress_m_ = 0.0;      ///< along the leg's path
  bool is_turning_ = false;      ///< on the spot, towards the path
  std::optional<Mark> mark_;     ///< last considerable progress
  RobotState robot_;             ///< at the last command
};

}  // namespace lapis::simulator
