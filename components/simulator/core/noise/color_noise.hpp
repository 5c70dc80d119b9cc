#pragma once

#include <cstdint>

#include <Eigen/Core>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

struct ColorNoiseConfig {
  double sigma = 2.5;     ///< standard deviation of every channel [1/255], 0 to 30
  double contrast = 1.0;  ///< differences from middle grey are scaled by this, 0 to 2
  double shutter = 0.0;   ///< share of the time between frames that the shutter is open, 0 to 1
};

/// Turns ideal colour into a camera's image: motion blur, contrast, noise. Frames are independent of each other.
class ColorNoise {
 public:
  ColorNoise(const ColorNoiseConfig& config, std::uint64_t seed) : config_(config), seed_(seed) {}

  /// @param flow_px mean motion of the image since the last frame (x right, y down)
  geometry::ColorImage apply(const geometry::ColorImage& ideal, std::uint64_t tick,
                             const Eigen::Vector2d& flow_px = {0, 0}) const;

 private:
  ColorNoiseConfig config_;
  std::uint64_t seed_;
};

}  // namespace lapis::simulator
