#include "simulator/core/sensors.hpp"

namespace lapis::simulator {
namespace {

constexpr double kGravity_m_s2 = 9.80665;

}  // namespace

void apply_drift(DriftPreset preset, SensorConfig& config) {
  const DriftScales scales = drift_scales(preset);
  config.color.contrast *= scales.texture;
  config.color.shutter += scales.blur;
  config.depth.extra_dropout += scales.dropout;
  config.depth.noise_multiplier *= scales.depth;
  config.odometry.scale *= scales.odometry;
}

Sensors::Sensors(const SensorConfig& config, const geometry::PinholeCamera& camera, const mapping::LabelList& labels,
                 std::uint64_t seed)
    : focal_px_(camera.fx), color_(config.color, seed), depth_(config.depth, seed),
      labels_(config.labels, labels, seed), odometry_(config.odometry, seed), imu_(config.imu, seed) {}

CameraImages Sensors::see(const RenderedFrame& ideal, const View& view) const {
  // A camera that turns left sees the world move right. The flow of driving forwards is small and differs from pixel to
  // pixel: it is neglected.
  const Eigen::Vector2d flow_px(focal_px_ * view.turn_rad, 0.0);
  return {color_.apply(ideal.color, view.tick, flow_px), depth_.apply(ideal.depth, ideal.cosines, focal_px_, view.tick),
          labels_.apply(ideal.labels, ideal.instances, ideal.depth, view.T_world_camera, view.tick)};
}

void Sensors::feel(const Motion& motion) {
  rolled_m_ += motion.distance_m;
  turned_rad_ += motion.turn_rad;
  felt_turn_rad_ += motion.turn_rad;
  felt_push_m_s_ += motion.acceleration * motion.duration_s;
}

OdometrySample Sensors::read_odometry(time::Time stamp, time::Duration period) {
  const OdometryStep step = odometry_.step(rolled_m_, turned_rad_);
  rolled_m_ = turned_rad_ = 0.0;
  const double period_s = period.seconds();
  OdometrySample out;
  out.stamp = stamp;
  out.position = odometry_.position();
  out.yaw_rad = odometry_.yaw_rad();
  out.pose_covariance = odometry_.covariance();
  out.velocity = {step.distance_m / period_s, step.turn_rad / period_s};
  out.velocity_covariance.diagonal() << step.distance_variance, 0.0, step.turn_variance;
  out.velocity_covariance /= period_s * period_s;
  return out;
}

ImuSample Sensors::read_imu(time::Time stamp, time::Duration period) {
  const double period_s = period.seconds();
  const Eigen::Vector3d acceleration(felt_push_m_s_.x() / period_s, felt_push_m_s_.y() / period_s, kGravity_m_s2);
  const ImuReading reading = imu_.read({0.0, 0.0, felt_turn_rad_ / period_s}, acceleration, period_s);
  felt_turn_rad_ = 0.0;
  felt_push_m_s_.setZero();
  return {stamp, reading.turn_rate_rad_s, reading.acceleration_m_s2, reading.turn_rate_variance,
          reading.acceleration_variance};
}

}  // namespace lapis::simulator
