#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "simulator/core/render/renderer.hpp"
#include "simulator/core/robot/robot.hpp"

namespace lapis::simulator {

struct SensorConfig {
  bool has_imu = false;
};

/// What the camera and a segmentation of its images give.
struct CameraImages {
  geometry::ColorImage color;
  geometry::Image<std::uint16_t> depth_mm;  ///< 0: none
  geometry::LabelImage labels;
};

/// Wheel odometry: pose since the start, in the frame in which the robot began.
struct WheelSample {
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

/// When and where a frame was seen.
struct View {
  std::uint64_t tick = 0;
  geometry::Pose T_world_camera;
};

/// The robot's sensors with their noise.
class Sensors {
 public:
  Sensors(const SensorConfig& config, const geometry::PinholeCamera& camera, std::uint64_t seed);

  CameraImages see(const RenderedFrame& ideal, const View& view) const;
  /// The wheels have turned.
  void roll(const Motion& motion);
  /// Odometry now.
  WheelSample wheels(time::Time stamp);
  /// Mean over a motion.
  ImuSample imu(const Motion& motion, time::Time stamp);

 private:
  SensorConfig config_;
  WheelSample pose_;
};

}  // namespace lapis::simulator
