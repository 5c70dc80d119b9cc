#pragma once

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/geometry/se3.hpp"
#include "slam/core/frame/frame.hpp"

namespace lapis::slam {

/// How far the depth camera is from where it was taken to be, in space and time. A pixel of depth `z` that is shown at
/// `pixel` belongs at
///   centre + focal_ratio * (pixel - centre) + focal lengths * shift_m / z - delay_s * (speed of the image there).
struct DepthOffset {
  double focal_ratio = 1.0;                           ///< focal length that was assumed / true focal length
  Eigen::Vector2d shift_m = Eigen::Vector2d::Zero();  ///< of the depth camera: x to the right, y down [m]
  double delay_s = 0.0;                               ///< how much later than colour depth was measured

  bool operator==(const DepthOffset& other) const = default;
};

/// What one frame shows of the offset: where depth jumps, and how strong the contrast of grey values is everywhere.
class EdgeView {
 public:
  static constexpr int kLevels = 4;

  explicit EdgeView(const RgbdFrame& frame);

  /// Between a near pixel and the far one beside it.
  struct Edge {
    Eigen::Vector2f pixel;
    float depth_m = 0.0F;  ///< of the near one
    bool is_upright = false;
  };
  const std::vector<Edge>& edges() const { return edges_; }
  /// Contrast across an edge as a multiple of the image's mean one, interpolated; 1 at and beyond the border.
  /// @param level of a pyramid: 0 is the image, each further one is blurred to half of the size.
  double contrast(const Eigen::Vector2d& pixel, bool is_upright, int level) const;
  const geometry::PinholeCamera& camera() const { return camera_; }
  /// Of the camera, in its own frame (translation, rotation) [m/s, rad/s]; zero until it is set.
  const geometry::Vector6d& velocity() const { return velocity_; }
  void set_velocity(const geometry::Vector6d& velocity) { velocity_ = velocity; }

 private:
  using Levels = std::array<geometry::Image<float>, kLevels>;

  geometry::PinholeCamera camera_;
  std::vector<Edge> edges_;
  Levels across_columns_, across_rows_;
  geometry::Vector6d velocity_ = geometry::Vector6d::Zero();
};

/// The offset that puts jumps of depth where grey values have contrast.
struct DepthAlignment {
  DepthOffset offset;
  double moved_px = 0.0;     ///< by how much it moves edges (RMS)
  double gain_sigmas = 0.0;  ///< by how much contrast at edges is larger than without it, over parts of the image
};

/// Searches focal ratios from 0.76 to 1.3 and shifts to 8 cm [cf. Levinson and Thrun, "Automatic online calibration of
/// cameras and lasers", RSS 2013: depth discontinuities at image edges]. The views show edges.
DepthAlignment align_depth(std::span<const EdgeView> views);

/// An offset with a delay, whose gain is that over the stated offset, and by how much contrast at edges is larger than
/// with the best offset without a delay.
struct LateAlignment {
  DepthAlignment alignment;
  double better_sigmas = 0.0;
};

/// The same with a delay of up to about `most_s`, either way, by views with edges and velocities. A delay that moves
/// edges by less than a pixel is none. It is sought with the depth camera where it is taken to be, and where it is
/// stated to be (`stated`): a wrong shift may have hidden it.
LateAlignment align_late_depth(std::span<const EdgeView> views, double most_s, const DepthOffset& stated = {});
/// By how much an offset moves the edges of the views (root mean square) [px].
double moved_px(std::span<const EdgeView> views, const DepthOffset& offset);

}  // namespace lapis::slam
