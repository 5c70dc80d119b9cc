#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "simulator/core/noise/color_noise.hpp"
#include "simulator/core/noise/depth_noise.hpp"
#include "simulator/core/noise/drift.hpp"
#include "simulator/core/noise/imu_noise.hpp"
#include "simulator/core/noise/label_noise.hpp"
#include "simulator/core/noise/wheel_odometry.hpp"
#include "simulator/core/render/renderer.hpp"
#include "simulator/core/robot/robot.hpp"

namespace lapis::simulator {

struct SensorConfig {
  ColorNoiseConfig color;
  DepthNoiseConfig depth;
  LabelNoiseConfig labels;
  OdometryNoiseConfig odometry;
  ImuNoiseConfig imu;
  bool has_imu = false;
};

/// Makes localisation as hard as the preset says: changes texture, blur, depth noise and odometry noise together.
void apply_drift(DriftPreset preset, SensorConfig& config);

/// Images of the camera, and their segmentation.
struct CameraImages {
  geometry::ColorImage color;
  geometry::Image<std::uint16_t> depth_mm;  ///< [mm]; 0: no depth
  geometry::LabelImage labels;
};

/// A sample of wheel odometry; the pose is relative to the one where the robot began.
struct OdometrySample {
  time::Time stamp;
  Eigen::Vector2d position{0, 0};
  double yaw_rad = 0.0;
  Eigen::Matrix3d pose_covariance = Eigen::Matrix3d::Zero();      ///< of (x, y, yaw) [m, m, rad]
  DriveCommand velocity;                                          ///< mean since the last sample
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();  ///< of (vx, vy, turn rate) [m/s, m/s, rad/s]
};

struct ImuSample {
  time::Time stamp;
  Eigen::Vector3d turn_rate_rad_s{0, 0, 0};    ///< about the axes of base_link
  Eigen::Vector3d acceleration_m_s2{0, 0, 0};  ///< in base_link, as an accelerometer measures it: +g along z at rest
  double turn_rate_variance = 0.0;             ///< of every axis [rad2/s2]
  double acceleration_variance = 0.0;          ///< of every axis [m2/s4]
};

/// Number and camera pose of a frame.
struct View {
  std::uint64_t tick = 0;
  geometry::Pose T_world_camera;
  double turn_rad = 0.0;  ///< turn of the camera about the vertical axis since the last frame; positive to the left
};

/// The robot's sensors with their noise. The noise of an image depends on its own frame only; odometry and IMU drift.
class Sensors {
 public:
  /// @param labels the classes that the segmentation knows
  Sensors(const SensorConfig& config, const geometry::PinholeCamera& camera, const mapping::LabelList& labels,
          std::uint64_t seed);

  CameraImages see(const RenderedFrame& ideal, const View& view) const;
  /// Notes a motion of the robot. Motions add up until odometry and IMU are read.
  void feel(const Motion& motion);
  /// Reads odometry: the motion of the wheels in the period that ends now, at `stamp`.
  OdometrySample read_odometry(time::Time stamp, time::Duration period);
  /// Reads the IMU: mean turn rate and acceleration of the body in the period that ends now, at `stamp`.
  ImuSample read_imu(time::Time stamp, time::Duration period);

 private:
  double focal_px_;
  ColorNoise color_;
  DepthNoise depth_;
  LabelNoise labels_;
  WheelOdometry odometry_;
  ImuNoise imu_;
  double rolled_m_ = 0.0;  // since the last reading of odometry
  double turned_rad_ = 0.0;
  double felt_turn_rad_ = 0.0;           // since the last reading of the IMU
  Eigen::Vector2d felt_push_m_s_{0, 0};  // change of velocity, along and across the heading
};

}  // namespace lapis::simulator
