#pragma once

#include <vector>

#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "idl/sensor_msgs.hpp"
#include "idl/tf2_msgs.hpp"
#include "idl/vision_msgs.hpp"

namespace lapis::test {

/// An RGB-D camera inside a box of 4 x 3 x 6 m whose walls carry a random texture: exact depth, exact labels, enough
/// corners for slam. The optical frame looks along z of the box at the start. Every call with the same arguments gives
/// the same bytes. With a lens the images, and the camera info, are distorted.
class SyntheticCamera {
 public:
  static constexpr const char* kOpticalFrame = "camera_color_optical_frame";
  static constexpr int kClasses = 6;  ///< one per wall, ids 1 to 6

  /// `distortion`: k1 k2 p1 p2 k3 of plumb_bob, or none.
  explicit SyntheticCamera(int width = 320, int height = 240, const std::vector<double>& distortion = {});

  const geometry::PinholeCamera& camera() const { return camera_; }
  sensor_msgs::msg::Image color(time::Time stamp, const geometry::Pose& T_box_camera) const;         ///< rgb8
  sensor_msgs::msg::Image depth(time::Time stamp, const geometry::Pose& T_box_camera) const;         ///< 16UC1 [mm]
  sensor_msgs::msg::Image depth_metres(time::Time stamp, const geometry::Pose& T_box_camera) const;  ///< 32FC1 [m]
  sensor_msgs::msg::Image labels(time::Time stamp, const geometry::Pose& T_box_camera) const;        ///< mono8
  sensor_msgs::msg::CameraInfo info(time::Time stamp) const;
  vision_msgs::msg::LabelInfo label_info() const;

 private:
  geometry::PinholeCamera camera_;
  std::vector<double> distortion_;
  std::vector<Eigen::Vector3d> rays_;  // of the pixels, row by row; z = 1
};

/// base_link -> camera_color_optical_frame, 0.3 m above the base, with `prefix` ("robot1/") before the frame ids.
tf2_msgs::msg::TFMessage camera_mount(const std::string& prefix = "");
/// The same as a pose.
geometry::Pose T_base_camera();

/// A slow motion: 1 cm forward and some sideways and yaw per frame.
geometry::Pose slow_motion(double frame);

}  // namespace lapis::test
