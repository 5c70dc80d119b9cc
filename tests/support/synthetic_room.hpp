#pragma once

#include <cstdint>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"

namespace lapis::test {

/// A furnished room made of axis-aligned boxes, rendered exactly by ray casting: depth and class images for tests and
/// benchmarks. World frame: z up, floor at z = 0, metres.
struct Box {
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  std::uint16_t label;
};

std::vector<Box> furnished_room();

struct RenderedFrame {
  geometry::DepthImage depth;  ///< z-depth [m], 0 = no surface
  geometry::LabelImage labels;
};

RenderedFrame render(const std::vector<Box>& boxes, const geometry::PinholeCamera& camera,
                     const geometry::Pose& T_world_camera);

/// Camera at a place, looking along `yaw_rad` (0 = +x, counter-clockwise) and `pitch_down_rad` below the horizon.
geometry::Pose look(const Eigen::Vector3d& p_world, double yaw_rad, double pitch_down_rad = 0.0);

}  // namespace lapis::test
