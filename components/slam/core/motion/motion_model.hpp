#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/config.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/odometry_track.hpp"

namespace lapis::slam {

/// Pose of a camera relative to a key-frame, with its covariance (right perturbation; translation, rotation).
struct RelativeCamera {
  KeyframeId reference = 0;
  geometry::Pose T_reference_camera = geometry::Pose::Identity();
  geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
};

/// Predicts the camera's pose from the last one that was found: by wheel odometry where there is any, else by constant
/// velocity. It keeps poses relative to a key-frame, so that they follow when key-frames move.
class MotionModel {
 public:
  /// `T_base_camera`: pose of the camera on the robot, for odometry.
  MotionModel(const SlamConfig& config, const geometry::Pose& T_base_camera)
      : max_gap_s_(config.tracker.max_prediction_s), assumed_speed_(assumed_speed(config.relocalization)),
        odometry_(config.odometry), wheels_(config.odometry), T_base_camera_(T_base_camera) {}

  /// See OdometryTrack::add.
  bool add_odometry(time::Time stamp, const geometry::Pose& T_odom_base) { return odometry_.add(stamp, T_odom_base); }
  /// Continues from a pose and odometry that were saved in the same run.
  void resume(time::Time stamp, const RelativeCamera& camera, std::span<const OdometryReading> odometry);
  /// The pose that was found last says nothing about those to come.
  void forget() { last_.reset(); }
  /// Call it when the pose of a frame was found.
  void update(const Map& map, time::Time stamp, const RelativeCamera& camera);
  /// T_map_camera that was found last, and its stamp; nothing before the first update.
  std::optional<std::pair<time::Time, geometry::Pose>> last_pose(const Map& map) const;
  /// Pose that motion predicts, with its covariance: that of dead_reckon; or by constant velocity, with accelerations
  /// as large as those of late, or where the velocity is unknown with that of RelocalizationConfig. Nothing in the same
  /// cases as predict.
  struct Expected {
    geometry::Pose T_map_camera = geometry::Pose::Identity();
    geometry::Matrix6d covariance = geometry::Matrix6d::Zero();
  };
  std::optional<Expected> expect(const Map& map, time::Time stamp) const;
  /// T_map_camera at a stamp; nothing before the first update and when neither odometry nor velocity reaches that far.
  std::optional<geometry::Pose> predict(const Map& map, time::Time stamp) const;
  /// Motion of the camera from `stamp`, where it has the pose `T_map_camera`, to another stamp: by the velocity since
  /// the pose that was found last. Nothing when that is too old, or none.
  std::optional<geometry::Pose> motion_through(const Map& map, time::Time stamp, const geometry::Pose& T_map_camera,
                                               time::Time to) const;
  /// Pose by odometry alone; its covariance grows with the path since the last update.
  std::optional<RelativeCamera> dead_reckon(time::Time stamp) const;
  /// Motion of the camera between two stamps by odometry, with the covariance in the tangent of the later pose.
  std::optional<OdometryMotion> odometry_between(time::Time from, time::Time to) const;
  /// See OdometryTrack::pose_at.
  std::optional<geometry::Pose> odometry_at(time::Time stamp) const { return odometry_.pose_at(stamp); }
  /// Calibrates the wheels with a motion of the camera that vision has measured, and its covariance.
  void learn_wheels(time::Time from, time::Time to, const geometry::Pose& T_from_to,
                    const geometry::Matrix6d& covariance);
  /// Continues with the calibration of an earlier run.
  void resume_wheels(const WheelCalibration& wheels);
  const WheelCalibration& wheels() const { return wheels_.belief(); }
  /// Stamp of the pose that was found last.
  std::optional<time::Time> last_stamp() const { return last_ ? std::optional(last_->stamp) : std::nullopt; }
  /// The pose that was found last, relative to its key-frame.
  std::optional<RelativeCamera> last_camera() const { return last_ ? std::optional(last_->camera) : std::nullopt; }
  /// See OdometryTrack::readings.
  std::vector<OdometryReading> odometry_readings() const { return odometry_.readings(); }
  /// Odometry before `stamp` will not be needed any more.
  void forget_before(time::Time stamp) { odometry_.forget_before(stamp); }

 private:
  struct Last {
    time::Time stamp;
    RelativeCamera camera;
    std::optional<geometry::Vector6d> velocity;  // [m/s, rad/s], camera frame
  };
  /// Of translation and rotation.
  struct Magnitude {
    double m = 0.0, rad = 0.0;
  };
  static Magnitude assumed_speed(const RelocalizationConfig& config) {
    return {config.speed_m_s, config.speed_m_s * config.near_rad / config.near_m};
  }
  void note_acceleration(const geometry::Vector6d& change, double elapsed_s);

  double max_gap_s_;
  Magnitude assumed_speed_;           // [m/s, rad/s]
  Magnitude acceleration_{1.0, 2.0};  // of late [m/s^2, rad/s^2]
  OdometryTrack odometry_;
  WheelCalibrator wheels_;
  geometry::Pose T_base_camera_;
  std::optional<Last> last_;
};

}  // namespace lapis::slam
