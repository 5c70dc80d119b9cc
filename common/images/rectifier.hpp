#pragma once

#include <memory>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"

namespace lapis::images {

/// Takes the lens distortion out of a camera's images: what comes out fits the same focal lengths and principal point
/// without distortion. Colour is interpolated; depth and labels are those of the nearest pixel, because a mean of two
/// surfaces or classes is neither. Pixels that the lens did not see are black, without depth, unlabelled.
/// All functions may be called from several threads.
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
  std::unique_ptr<const Maps> maps_;  // null: nothing to do
};

}  // namespace lapis::images
