#pragma once

#include "slam/core/config.hpp"

namespace lapis::slam {

/// Standard deviation [m] of a depth measurement at z-depth `depth_m`.
inline double depth_sigma(const NoiseConfig& config, double depth_m) {
  return config.depth_sigma_m + config.depth_sigma_per_m * depth_m * depth_m;
}
/// True when a depth [m] is within the configured range.
inline bool is_depth(const NoiseConfig& config, double depth_m) {
  return depth_m >= config.min_depth_m && depth_m <= config.max_depth_m;  // false for NaN
}

}  // namespace lapis::slam
