#pragma once

#include <memory>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"

namespace lapis::images {

/// Removes the lens distortion from a camera's images: the result has the same focal lengths and principal point, but
/// no distortion. Colour is interpolated; depth and labels are those of the nearest pixel, because the mean of two
/// surfaces or of two classes is neither of them. Pixels that the lens did not see are black, without depth and
/// unlabelled.
class Rectifier {
 public:
  explicit Rectifier(const geometry::LensCamera& camera);
  ~Rectifier();
  Rectifier(const Rectifier&) = delete;
  Rectifier& operator=(const Rectifier&) = delete;

  /// The image must have the camera's size. Without distortion it stays as it is.
  void rectify(geometry::ColorImage& image) const;
  void rectify(geometry::GrayImage& image) const;
  void rectify(geometry::DepthImage& image) const;
  /// Depth in millimetres, or labels.
  void rectify(geometry::Image<std::uint16_t>& image) const;

 private:
  struct Maps;
  std::unique_ptr<const Maps> maps_;  // null: the lens has no distortion
};

/// Keeps the rectifier of the camera that was asked for last, because its tables take longer than a frame.
class KeptRectifier {
 public:
  const Rectifier& of(const geometry::LensCamera& camera);

 private:
  geometry::LensCamera camera_;
  std::unique_ptr<const Rectifier> rectifier_;  // of camera_
};

}  // namespace lapis::images
