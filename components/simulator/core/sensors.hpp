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

/// Makes localisation as hard as the preset says: visual difficulty and noise of odometry together.
void apply_drift(DriftPreset preset, SensorConfig& config);

/// What the camera and a segmentation of its images give.
struct CameraImages {
  geometry::ColorImage color;
  geometry::Image<std::uint16_t> depth_mm;  ///< 0: none
  geometry::LabelImage labels;
};

/// Wheel odometry: pose since the start, in the frame in which the robot began.
struct OdometrySample {
  time::Time stamp;
  Eigen::Vector2d position{0, 0};
  double yaw_rad = 0.0;
  Eigen::Matrix3d pose_covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw)
  DriveCommand velocity;                                      ///< mean since the last sample
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
};

struct ImuSample {
  time::Time stamp;
  Eigen::Vector3d turn_rate_rad_s{0, 0, 0};    ///< about the axes of base_link
  Eigen::Vector3d acceleration_m_s2{0, 0, 0};  ///< with gravity
  double turn_rate_variance = 0.0;
  double acceleration_variance = 0.0;
};

/// When and from where a frame was seen.
struct View {
  std::uint64_t tick = 0;
  geometry::Pose T_world_camera;
  double turn_rad = 0.0;  ///< of the camera about its vertical axis since the last frame, to the left
};

/// The robot's sensors with their noise. Images depend on their own frame only; odometry and IMU drift.
class Sensors {
 public:
  /// @param labels the classes that the segmentation knows
  Sensors(const SensorConfig& config, const geometry::PinholeCamera& camera, const mapping::LabelList& labels,
          std::uint64_t seed);

  CameraImages see(const RenderedFrame& ideal, const View& view) const;
  /// The robot has moved: added up until odometry and IMU are read.
  void feel(const Motion& motion);
  /// Odometry of what the wheels rolled in the period that ends now.
  OdometrySample read_odometry(time::Time stamp, time::Duration period);
  /// Mean of what the body felt in the period that ends now.
  ImuSample read_imu(time::Time stamp, time::Duration period);

 private:
  double focal_px_;
  ColorNoise color_;
  DepthNoise depth_;
  LabelNoise labels_;
  WheelOdometry odometry_;
  ImuNoise imu_;
  double rolled_m_ = 0.0;  // since the last odometry
  double turned_rad_ = 0.0;
  double felt_turn_rad_ = 0.0;           // since the last reading of the IMU
  Eigen::Vector2d felt_push_m_s_{0, 0};  // change of velocity, along and across the heading
};

}  // namespace lapis::simulator
