#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/geometry/camera_mount.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/time/time.hpp"
#include "simulator/core/robot/robot.hpp"
#include "simulator/core/sensors.hpp"
#include "simulator/core/world.hpp"

namespace lapis::simulator {

/// How far the drives are from doing as they are told.
struct DriveErrorConfig {
  double speed_error = 0.0;  ///< largest relative error of the speed, drawn uniformly once per run, 0 to 0.5
  double turn_error = 0.0;   ///< the same of the turn rate
  double noise = 0.0;        ///< relative standard deviation of speed and turn rate under each command, 0 to 0.5
};

struct SimulationConfig {
  std::uint64_t seed = 1;
  double camera_rate_hz = 15.0;
  geometry::PinholeCamera camera;
  geometry::CameraMount mount;
  RobotConfig robot;
  DriveErrorConfig drive;
  SensorConfig sensors;
};

/// Everything that is sensed between two frames, and its ground truth.
struct SensorFrame {
  std::uint64_t tick = 0;
  time::Time stamp;
  CameraImages images;
  geometry::DepthImage ideal_depth;  ///< without noise [m]
  geometry::LabelImage ideal_labels;
  RobotState robot;
  geometry::Pose T_world_base;
  double turn_rate_rad_s = 0.0;  ///< of the base
  bool is_in_contact = false;
  double push_m_s = 0.0;  ///< greatest speed towards a touched object since the last frame
  std::vector<OdometrySample> odometry;
  std::vector<ImuSample> imu;
};

/// A robot that drives in a world and senses it. Time advances from frame to frame: frame k is at k / rate. The result
/// is a pure function of world, configuration, start, and the commands so far.
class Simulation {
 public:
  /// @param world must outlive the simulation.
  /// @throws std::runtime_error when the robot does not fit at the start.
  Simulation(const World& world, const SimulationConfig& config, const StartPose& start);

  /// The next frame. `command` was given at the time of the last one; without commands the watchdog stops the robot
  /// after RobotConfig::command_timeout.
  SensorFrame next(const std::optional<DriveCommand>& command);
  /// Number of commands that were refused because they were not finite.
  std::uint64_t commands_refused() const { return commands_refused_; }

 private:
  time::Time stamp_of(std::uint64_t tick) const;
  void drive_to(time::Time stamp, SensorFrame& frame);
  geometry::Pose T_world_base() const;
  DriveFactors drive_factors() const;

  const World& world_;
  SimulationConfig config_;
  Robot robot_;
  Sensors sensors_;
  std::uint64_t tick_ = 0;
  std::uint64_t commands_refused_ = 0;
};

}  // namespace lapis::simulator
