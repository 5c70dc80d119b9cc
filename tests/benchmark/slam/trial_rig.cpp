#include "tests/benchmark/slam/trial_rig.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/benchmark/slam/tour_recording.hpp"

namespace lapis::slam::benchmark {
namespace {

using geometry::Pose;
using simulator::DriveCommand;
using simulator::OdometrySample;
using simulator::RobotState;
using simulator::StartPose;

RobotState at_rest(const StartPose& place, time::Time stamp) {
  RobotState state;
  state.stamp = stamp;
  state.position = place.position;
  state.yaw_rad = place.yaw_rad;
  return state;
}

}  // namespace

TrialRig::TrialRig(const simulator::World& world, const simulator::SimulationConfig& config, const StartPose& start)
    : world_(world), config_(config), robot_(world.nav_map(), config.robot, at_rest(start, {})),
      sensors_(config.sensors, config.camera, world.scene().labels, config.seed) {}

Pose TrialRig::T_world_camera() const {
  const Pose T_world_base = planar(robot().position, robot().yaw_rad, world_.scene().floor_z_m);
  return T_world_base * T_base_camera(config_.mount);
}

std::vector<OdometrySample> TrialRig::advance(const DriveCommand& command) { return drive(command, true); }

std::vector<OdometrySample> TrialRig::hang() { return drive({}, false); }

void TrialRig::set_down(const StartPose& place) {
  robot_ = simulator::Robot(world_.nav_map(), config_.robot, at_rest(place, robot().stamp));
}

std::vector<OdometrySample> TrialRig::drive(const DriveCommand& command, bool wheels_turn) {
  constexpr std::int64_t kOdometryPeriod_ns = 20'000'000;
  const time::Time stamp{std::llround(static_cast<double>(++tick_) * 1e9 / config_.camera_rate_hz)};
  const double yaw_before_rad = robot().yaw_rad;
  if (!robot_.command(command)) throw std::runtime_error("a command is not finite");
  std::vector<OdometrySample> odometry;
  while (robot().stamp < stamp) {
    const time::Time due{(robot().stamp.nanoseconds / kOdometryPeriod_ns + 1) * kOdometryPeriod_ns};
    const simulator::Motion motion = robot_.advance(std::min(stamp, due));
    if (wheels_turn) sensors_.feel(motion);
    if (robot().stamp == due) odometry.push_back(sensors_.read_odometry(due, {kOdometryPeriod_ns}));
  }
  turned_rad_ = std::remainder(robot().yaw_rad - yaw_before_rad, 2.0 * std::numbers::pi);
  return odometry;
}

RgbdFrame TrialRig::see() const {
  const simulator::View view{tick_, T_world_camera(), turned_rad_};
  const auto ideal = world_.renderer().render(config_.camera, view.T_world_camera);
  return to_frame(robot().stamp, config_.camera, sensors_.see(ideal, view));
}

RgbdFrame TrialRig::see_cover(bool with_depth) const {
  constexpr double kGrey = 90.0, kSigma = 2.5;  // of 255; sensor noise
  constexpr float kDistance_m = 0.3F;
  RgbdFrame frame = black_frame(robot().stamp, config_.camera);
  if (!with_depth) return frame;
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), kDistance_m);
  std::mt19937_64 generator(config_.seed * 100'000 + tick_);
  std::normal_distribution<double> noise(kGrey, kSigma);
  for (auto& pixel : frame.gray.pixels) pixel = static_cast<std::uint8_t>(std::lround(noise(generator)));
  return frame;
}

}  // namespace lapis::slam::benchmark
