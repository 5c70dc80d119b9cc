#pragma once

#include <cstdint>
#include <numbers>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

enum class DepthModel {
  kNone,      ///< ideal depth in millimetres, up to 65.5 m
  kKinect,    ///< Nguyen, Izadi, Lovell, 3DIMPVT 2012
  kRedwood,   ///< Choi, Zhou, Koltun, CVPR 2015, without the distortion table
  kRealsense  ///< stereo with 0.08 px of disparity noise and a base of 0.05 m
};

struct DepthNoiseConfig {
  DepthModel model = DepthModel::kKinect;
  double noise_multiplier = 1.0;  ///< factor on the model's standard deviations, 0 to 10
  double min_range_m = 0.3;       ///< nearer surfaces have no depth, > 0
  double max_range_m = 6.0;       ///< farther surfaces have no depth, at most 65
  double edge_slope = 0.08;       ///< relative change of depth from pixel to pixel that makes an edge, > 0
  double edge_dropout = 0.4;      ///< share of edge pixels without depth, 0 to 1
  double max_angle_rad = 80.0 * std::numbers::pi / 180.0;  ///< between ray and normal; beyond it, no depth
  double extra_dropout = 0.0;                              ///< share of all pixels without depth, 0 to 1
};

/// Turns ideal depth into the measurement of a depth camera. Frames are independent of each other.
class DepthNoise {
 public:
  DepthNoise(const DepthNoiseConfig& config, std::uint64_t seed) : config_(config), seed_(seed) {}

  /// @param ideal z-depth [m]; pixels without depth stay without
  /// @param cosines |cos| of the angle between ray and surface normal, of the size of `ideal`
  /// @param focal_px focal length (for kRealsense)
  /// @return z-depth [mm], 0: none
  /// @throws std::invalid_argument when the sizes differ
  geometry::Image<std::uint16_t> apply(const geometry::DepthImage& ideal, const geometry::Image<float>& cosines,
                                       double focal_px, std::uint64_t tick) const;

 private:
  DepthNoiseConfig config_;
  std::uint64_t seed_;
};

}  // namespace lapis::simulator
