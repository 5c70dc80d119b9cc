#pragma once

#include <memory>

#include "sensor_replay/core/camera_file.hpp"
#include "sensor_replay/core/image_file.hpp"

namespace lapis::sensor_replay {

/// Takes the lens distortion out of a camera's images: what comes out fits the same focal lengths and principal point
/// without distortion. Colour is interpolated; depth and labels are those of the nearest pixel, because a mean of two
/// surfaces or classes is neither. Pixels that the lens did not see are black, without depth, unlabelled.
/// All functions may be called from several threads.
class Rectifier {
 public:
  explicit Rectifier(const CameraFile& file);
  ~Rectifier();
  Rectifier(const Rectifier&) = delete;
  Rectifier& operator=(const Rectifier&) = delete;

  /// The image must have the camera's size. Without distortion it stays as it is.
  void rectify(geometry::ColorImage& image) const;
  /// Depth or labels.
  void rectify(geometry::Image<std::uint16_t>& image) const;

 private:
  struct Maps;
  std::unique_ptr<const Maps> maps_;  // null: nothing to do
};

}  // namespace lapis::sensor_replay
