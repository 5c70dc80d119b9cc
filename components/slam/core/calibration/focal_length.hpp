#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "slam/core/config.hpp"
#include "slam/core/map/map.hpp"

namespace lapis::slam {

/// A point that two images of one camera show; its depth is registered to the image.
struct SharedPoint {
  Eigen::Vector2d first = Eigen::Vector2d::Zero();  ///< [px]
  double first_depth_m = 0.0;
  double first_sigma_px = 1.0;
  Eigen::Vector2d second = Eigen::Vector2d::Zero();  ///< [px]
  double second_depth_m = 0.0;                       ///< 0: none
  double second_sigma_px = 1.0;
};

/// A measurement of log(true focal length / assumed one), which fx and fy share.
struct FocalEvidence {
  double log_ratio = 0.0;
  double information = 0.0;  ///< inverse variance, with the motion between the images unknown
};

/// The focal length that explains best where two images show the same points, whatever the motion between them. A turn
/// shows it: pixels near the border move by more than those in the middle, in proportion to its square. Gauss-Newton
/// with Huber weights over motion and focal length, of which the motion is eliminated.
/// @param T_second_first motion to begin with; @return nothing when there are too few points or the search fails
std::optional<FocalEvidence> measure_focal_length(const NoiseConfig& noise, const geometry::PinholeCamera& camera,
                                                  const geometry::Pose& T_second_first,
                                                  const std::vector<SharedPoint>& points);

/// Finds out from the key-frames of a map whether their camera has the focal length that is stated for it.
class FocalLengthWatch {
 public:
  FocalLengthWatch(const NoiseConfig& noise, double scale_factor) : noise_(noise), scale_factor_(scale_factor) {}

  /// A key-frame has been added to the map.
  void add(const Map& map, KeyframeId id);
  /// true / stated focal length, and the standard deviation of its logarithm by the scatter of what key-frames show;
  /// nothing while these are too few.
  struct Estimate {
    double ratio = 1.0;
    double sigma = 0.0;
    std::size_t keyframes = 0;
  };
  std::optional<Estimate> estimate() const;
  /// The estimate when it differs from 1 beyond doubt, and by enough to matter.
  std::optional<Estimate> contradiction() const;
  /// The same for a focal length that is known to be estimated: what is left of the error is less, and asks for less.
  /// Matches that contradicted the wrong one were dropped, so the first estimate is too near to it.
  std::optional<Estimate> refinement() const;

 private:
  NoiseConfig noise_;
  double scale_factor_;
  std::vector<FocalEvidence> evidence_;  // of one key-frame each
};

}  // namespace lapis::slam
