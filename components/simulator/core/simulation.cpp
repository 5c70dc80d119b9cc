#include "simulator/core/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

constexpr time::Duration kOdometryPeriod{20'000'000};  // 50 Hz
constexpr time::Duration kImuPeriod{5'000'000};        // 200 Hz

/// First multiple of `period` after `t`.
time::Time next_multiple(time::Time t, time::Duration period) {
  return {(t.nanoseconds / period.nanoseconds + 1) * period.nanoseconds};
}

RobotState at_rest(const StartPose& start) {
  RobotState state;
  state.position = start.position;
  state.yaw_rad = start.yaw_rad;
  return state;
}

}  // namespace

Simulation::Simulation(const World& world, const SimulationConfig& config, const StartPose& start)
    : world_(world), config_(config), robot_(world.nav_map(), config.robot, at_rest(start)),
      sensors_(config.sensors, config.camera, world.scene().labels, config.seed) {}

/// Time in whole nanoseconds, computed from the number of the frame alone, so that rounding errors do not add up.
time::Time Simulation::stamp_of(std::uint64_t tick) const {
  return {std::llround(static_cast<double>(tick) * 1e9 / config_.camera_rate_hz)};
}

SensorFrame Simulation::next(const std::optional<DriveCommand>& command) {
  if (command && !robot_.command(*command, drive_factors())) ++commands_refused_;
  SensorFrame frame;
  frame.tick = ++tick_;
  frame.stamp = stamp_of(tick_);
  const double yaw_before_rad = robot_.state().yaw_rad;
  drive_to(frame.stamp, frame);
  frame.T_world_base = T_world_base();
  frame.robot = robot_.state();
  const geometry::Pose T_world_camera = frame.T_world_base * T_base_camera(config_.mount);
  RenderedFrame ideal = world_.renderer().render(config_.camera, T_world_camera);
  const double turn_rad = std::remainder(frame.robot.yaw_rad - yaw_before_rad, 2.0 * std::numbers::pi);
  frame.images = sensors_.see(ideal, {frame.tick, T_world_camera, turn_rad});
  frame.ideal_depth = std::move(ideal.depth);
  frame.ideal_labels = std::move(ideal.labels);
  return frame;
}

/// What the drives make of the command of this tick.
DriveFactors Simulation::drive_factors() const {
  const DriveErrorConfig& drive = config_.drive;
  const Random of_run(config_.seed, RandomStream::kDrive), of_tick(config_.seed, RandomStream::kDrive, tick_ + 1);
  const auto factor = [&](std::uint64_t i, double error) {
    return (1.0 + of_run.uniform(i, -error, error)) * (1.0 + drive.noise * of_tick.normal(i));
  };
  return {factor(0, drive.speed_error), factor(1, drive.turn_error)};
}

/// Drives in steps, from one sample of a sensor to the next.
void Simulation::drive_to(time::Time stamp, SensorFrame& frame) {
  while (robot_.state().stamp < stamp) {
    const time::Time now = robot_.state().stamp;
    const time::Time imu_due = next_multiple(now, kImuPeriod);
    const time::Time until = std::min(stamp, config_.sensors.has_imu ? imu_due : next_multiple(now, kOdometryPeriod));
    const Motion motion = robot_.advance(until);
    frame.is_in_contact |= motion.is_in_contact;
    frame.push_m_s = std::max(frame.push_m_s, motion.push_m_s);
    frame.turn_rate_rad_s = motion.turn_rate_rad_s;
    sensors_.feel(motion);
    if (until == next_multiple(now, kOdometryPeriod))
      frame.odometry.push_back(sensors_.read_odometry(until, kOdometryPeriod));
    if (config_.sensors.has_imu && until == imu_due) frame.imu.push_back(sensors_.read_imu(until, kImuPeriod));
  }
}

geometry::Pose Simulation::T_world_base() const {
  const RobotState& state = robot_.state();
  const Eigen::Vector3d position(state.position.x(), state.position.y(), world_.scene().floor_z_m);
  return geometry::make_pose(position, Eigen::Quaterniond(Eigen::AngleAxisd(state.yaw_rad, Eigen::Vector3d::UnitZ())));
}

}  // namespace lapis::simulator
