#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/geometry/pinhole_camera.hpp"

namespace lapis::planner {

/// The rays that represent what a camera sees from a pose.
struct ViewConfig {
  geometry::PinholeCamera camera;  ///< rays cover its whole image
  int columns = 64;                ///< of rays, evenly spaced over the image; in [1, 4096]
  int rows = 36;                   ///< in [1, 4096]
  double range_m = 10.0;           ///< Euclidean, in (0, 100]
  /// A ray ends where the probability of reaching a cell falls below this, in [0, 1). A clamped wall lets 1e-4 through.
  double min_reach = 1e-5;
};

/// The rays of a ViewConfig.
class View {
 public:
  /// Throws std::runtime_error naming the value that is out of range.
  explicit View(const ViewConfig& config);

  const ViewConfig& config() const { return config_; }
  /// Unit vectors in the camera's optical frame, row by row.
  const std::vector<Eigen::Vector3d>& directions() const { return directions_; }
  /// Corners of a pyramid with its tip at the camera that contains all rays [m], optical frame.
  const std::vector<Eigen::Vector3d>& corners() const { return corners_; }

 private:
  ViewConfig config_;
  std::vector<Eigen::Vector3d> directions_;
  std::vector<Eigen::Vector3d> corners_;
};

}  // namespace lapis::planner
