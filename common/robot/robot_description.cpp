#include "common/robot/robot_description.hpp"

#include <cmath>
#include <numbers>

namespace lapis::robot {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;

double focal_length(int pixels, double field_of_view_deg) {
  return 0.5 * pixels / std::tan(0.5 * field_of_view_deg * kRadians);
}

}  // namespace

geometry::PinholeCamera pinhole_camera(const CameraDescription& camera) {
  return {camera.width,
          camera.height,
          focal_length(camera.width, camera.horizontal_fov_deg),
          focal_length(camera.height, camera.vertical_fov_deg),
          0.5 * (camera.width - 1),
          0.5 * (camera.height - 1)};
}

geometry::CameraMount camera_mount(const CameraDescription& camera) {
  return {camera.height_m, camera.pitch_down_deg * kRadians};
}

}  // namespace lapis::robot
