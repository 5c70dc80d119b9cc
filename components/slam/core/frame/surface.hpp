#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// Small plane on a surface seen by a key-frame, in that key-frame's optical frame.
struct SurfaceSample {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< [m]
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, towards the camera
};

/// Fits a plane to each cell of a regular grid on the depth image (edge SurfaceConfig::grid_step_px), and returns those
/// where the surface is flat and not seen edge-on.
std::vector<SurfaceSample> sample_surface(const SurfaceConfig& config, const NoiseConfig& noise,
                                          const geometry::PinholeCamera& camera, const geometry::DepthImage& depth);

}  // namespace lapis::slam
