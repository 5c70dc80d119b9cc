#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/simulation.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam::benchmark {

/// As simulator::Simulation, but only frames that are looked at are rendered, and the robot can be carried.
class TrialRig {
 public:
  /// @param world must outlive the rig.
  /// @throws std::runtime_error when the robot does not fit at the start.
  TrialRig(const simulator::World& world, const simulator::SimulationConfig& config, const simulator::StartPose& start);

  const simulator::RobotState& robot() const { return robot_.state(); }
  geometry::Pose T_world_camera() const;

  /// Drives to the next frame's stamp; what odometry said on the way.
  std::vector<simulator::OdometrySample> advance(const simulator::DriveCommand& command);
  /// The same time in somebody's hands: the wheels do not turn, and odometry says so.
  std::vector<simulator::OdometrySample> hang();
  /// Stands elsewhere from now on.
  /// @throws std::runtime_error when the robot does not fit there.
  void set_down(const simulator::StartPose& place);

  RgbdFrame see() const;
  /// Black without depth, or grey with noise and depth.
  RgbdFrame see_cover(bool with_depth) const;

 private:
  std::vector<simulator::OdometrySample> drive(const simulator::DriveCommand& command, bool wheels_turn);

  const simulator::World& world_;
  simulator::SimulationConfig config_;
  simulator::Robot robot_;
  simulator::Sensors sensors_;
  std::uint64_t tick_ = 0;
  double turned_rad_ = 0.0;  // since the frame before
};

}  // namespace lapis::slam::benchmark
