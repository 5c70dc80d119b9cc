#include "common/geometry/pinhole_camera.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::geometry {

bool is_valid(const PinholeCamera& camera) {
  return camera.width > 0 && camera.height > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy) &&
         std::isfinite(camera.cx) && std::isfinite(camera.cy) && camera.fx > 0.0 && camera.fy > 0.0;
}

bool LensCamera::is_distorted() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double d) { return d != 0.0; });
}

}  // namespace lapis::geometry
