#include "tests/support/synthetic_room.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lapis::test {
namespace {

/// Entry of a ray into a box, as multiple of `direction`; infinity when it misses or starts inside.
double distance_to(const Box& box, const Eigen::Vector3d& origin, const Eigen::Vector3d& inverse_direction) {
  double enter = 0.0, leave = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double a = (box.low[axis] - origin[axis]) * inverse_direction[axis];
    const double b = (box.high[axis] - origin[axis]) * inverse_direction[axis];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter > 0.0 && enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<Box> furnished_room() {
  constexpr double kThickness = 0.3;
  return {
      {{-4 - kThickness, -3, 0}, {-4, 3, 2.6}, 1},  // walls
      {{4, -3, 0}, {4 + kThickness, 3, 2.6}, 1},    {{-4, -3 - kThickness, 0}, {4, -3, 2.6}, 1},
      {{-4, 3, 0}, {4, 3 + kThickness, 2.6}, 1},    {{-4, -3, -kThickness}, {4, 3, 0}, 2},  // floor
      {{-4, -3, 2.6}, {4, 3, 2.6 + kThickness}, 3},                                         // ceiling
      {{1.0, -0.6, 0.7}, {2.2, 0.6, 0.75}, 6},                                              // table top and legs
      {{1.0, -0.6, 0}, {1.06, -0.54, 0.7}, 6},      {{2.14, 0.54, 0}, {2.2, 0.6, 0.7}, 6},
      {{2.4, -0.3, 0}, {2.9, 0.3, 0.45}, 7},     // chair
      {{-1.5, 2.2, 0}, {0.5, 3, 0.8}, 8},        // sofa
      {{-4, -1.5, 0}, {-3.4, 0.5, 2.0}, 10},     // cabinet
      {{3.95, 1.0, 1.2}, {4, 2.0, 1.8}, 12},     // picture
      {{-0.4, -3, 0}, {0.5, -2.95, 2.0}, 4},     // door
      {{-3.0, -2.9, 0}, {-2.6, -2.5, 1.1}, 17},  // plant
      {{1.4, -0.1, 0.75}, {1.6, 0.1, 1.0}, 18},  // object on the table
      {{1.0, 2.5, 0}, {3.0, 3, 0.9}, 11},        // shelf
      {{-2.0, -1.0, 0}, {-0.5, 0.6, 0.02}, 23},  // rug
  };
}

RenderedFrame render(const std::vector<Box>& boxes, const geometry::PinholeCamera& camera,
                     const geometry::Pose& T_world_camera) {
  RenderedFrame frame{geometry::DepthImage(camera.width, camera.height),
                      geometry::LabelImage(camera.width, camera.height)};
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) {
      // Direction with z = 1 in the camera frame: its multiple is the z-depth.
      const Eigen::Vector3d direction = T_world_camera.linear() * camera.unproject(column, row, 1.0);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Box& box : boxes) {
        const double depth = distance_to(box, T_world_camera.translation(), direction.cwiseInverse());
        if (depth >= nearest) continue;
        nearest = depth;
        frame.labels(column, row) = box.label;
      }
      if (std::isfinite(nearest)) frame.depth(column, row) = static_cast<float>(nearest);
    }
  return frame;
}

geometry::Pose look(const Eigen::Vector3d& p_world, double yaw_rad, double pitch_down_rad) {
  Eigen::Matrix3d R_level_camera;  // camera x right, y down, z forward, seen from x forward, y left, z up
  R_level_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  geometry::Pose T = geometry::Pose::Identity();
  T.linear() = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
               Eigen::AngleAxisd(pitch_down_rad, Eigen::Vector3d::UnitY()).toRotationMatrix() * R_level_camera;
  T.translation() = p_world;
  return T;
}

}  // namespace lapis::test
