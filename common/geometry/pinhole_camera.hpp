#pragma once

#include <Eigen/Core>
#include <vector>

namespace lapis::geometry {

/// Pinhole camera without distortion; optical frame: x right, y down, z forward [REP 103]. Pixel (0, 0) is the centre
/// of the top-left pixel.
struct PinholeCamera {
  int width = 0;    ///< [px]
  int height = 0;   ///< [px]
  double fx = 0.0;  ///< [px]
  double fy = 0.0;  ///< [px]
  double cx = 0.0;  ///< [px]
  double cy = 0.0;  ///< [px]

  /// Pixel of a point in the optical frame; z must be positive.
  Eigen::Vector2d project(const Eigen::Vector3d& p_camera) const {
    return {fx * p_camera.x() / p_camera.z() + cx, fy * p_camera.y() / p_camera.z() + cy};
  }
  /// Point in the optical frame at z-depth `depth_m` behind a pixel.
  Eigen::Vector3d unproject(double u, double v, double depth_m) const {
    return {(u - cx) / fx * depth_m, (v - cy) / fy * depth_m, depth_m};
  }
  /// True when a pixel lies on the image with `margin` pixels to spare.
  bool contains(const Eigen::Vector2d& pixel, double margin = 0.0) const {
    return pixel.x() >= margin && pixel.y() >= margin && pixel.x() <= width - 1 - margin &&
           pixel.y() <= height - 1 - margin;
  }
  bool operator==(const PinholeCamera&) const = default;
};

/// True when the size and the focal lengths are positive and all parameters are finite.
bool is_valid(const PinholeCamera& camera);

/// A pinhole camera behind a lens that bends rays radially and tangentially (Brown, "Decentering distortion of lenses",
/// 1966).
struct LensCamera {
  PinholeCamera pinhole;
  /// Empty, or k1 k2 p1 p2, optionally followed by k3 or by k3 k4 k5 k6: ROS's models plumb_bob and
  /// rational_polynomial, which are those of OpenCV.
  std::vector<double> distortion;

  bool is_distorted() const;
  bool operator==(const LensCamera&) const = default;
};

}  // namespace lapis::geometry
