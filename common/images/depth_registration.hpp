#pragma once

#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "common/images/rectifier.hpp"

namespace lapis::images {

/// The two cameras of an RGB-D sensor, as their camera infos and /tf_static state them.
struct RgbdCalibration {
  geometry::LensCamera color;
  geometry::LensCamera depth;
  geometry::Pose T_color_depth = geometry::Pose::Identity();  ///< depth camera in the colour camera's optical frame

  /// True when depth, once rectified, is already what the rectified colour camera sees.
  bool is_registered() const;
  bool operator==(const RgbdCalibration& other) const;
};

/// Brings depth images to the view of the colour camera without its lens distortion: each pixel of the result has the
/// depth of the nearest surface that the depth camera has seen there, at the pixel's centre. What the colour camera
/// sees, but the depth camera does not, is without depth.
class DepthRegistration {
 public:
  explicit DepthRegistration(const RgbdCalibration& calibration);

  const RgbdCalibration& calibration() const { return calibration_; }
  /// @param depth as recorded, of the size of the depth camera: depth along its optical axis [m], 0: none.
  /// @return of the size of the colour camera: depth along its optical axis [m], 0: none.
  geometry::DepthImage operator()(geometry::DepthImage depth) const;

 private:
  class InverseDepth;
  /// Draws a depth pixel, as a part of its surface, where the colour camera sees it; `result` has 1 / depth.
  void draw(float depth_m, const InverseDepth& inverse, int column, int row, geometry::DepthImage& result) const;

  RgbdCalibration calibration_;
  Rectifier rectifier_;                          // of the depth camera
  std::vector<Eigen::Vector3f> columns_, rows_;  // their sums are the rays of depth pixels in the colour camera
  Eigen::Vector3f shift_;                        // of the depth camera [m]
  Eigen::Vector2f focal_px_, centre_px_;         // of colour
  Eigen::Vector2f reach_px_;                     // from the centre of a depth pixel to its edge, in colour pixels
  Eigen::Vector2f pixels_per_px_;                // of depth, per pixel of colour
};

}  // namespace lapis::images
