#pragma once

#include <optional>

#include "common/time/time.hpp"
#include "controller/core/motion.hpp"
#include "controller/core/planar.hpp"

namespace lapis::controller {

/// How the robot's drives follow commands.
struct DriveModel {
  double lag_s = 0.15;  ///< time constant, > 0
  double max_acceleration_m_s2 = 1.5;
  double max_turn_acceleration_rad_s2 = 4.0;
  time::Duration latency{66'666'667};           ///< from a command until the drives follow it
  time::Duration command_timeout{200'000'000};  ///< after this time without a command the robot stops by itself
};

/// Dead reckoning by commands alone, for a robot that measures no motion: where its drives would have taken it if they
/// did as they are told. Slip, contacts and the drives' errors are not in it.
class CommandOdometry {
 public:
  explicit CommandOdometry(const DriveModel& model) : model_(model) {}

  /// Adds the next command, given at `now`. Until stamp(), which is `now` plus the latency, the motion is then known.
  /// Where a clock goes back, by less than a second no time passes until it is there again; by more, time begins anew.
  void add(const Velocity& command, time::Time now);

  time::Time stamp() const { return stamp_; }
  /// base_link at stamp() in the frame in which it was at the first command.
  const PlanarPose& T_odom_base() const { return T_odom_base_; }
  const Velocity& velocity() const { return velocity_; }  ///< of the drives, at stamp()

 private:
  void advance(double elapsed_s, const Velocity& target);

  DriveModel model_;
  time::Time stamp_;
  std::optional<Velocity> command_;  // from stamp_ on
  Velocity velocity_;
  PlanarPose T_odom_base_ = PlanarPose::Identity();
};

}  // namespace lapis::controller
