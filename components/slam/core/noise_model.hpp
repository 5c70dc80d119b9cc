#pragma once

#include "slam/core/config.hpp"

namespace lapis::slam {

/// Standard deviation [m] of a depth measurement at z-depth `depth_m`.
double depth_sigma(const NoiseConfig& config, double depth_m);
/// True when a depth [m] is a measurement inside the range in use.
bool is_depth(const NoiseConfig& config, double depth_m);

}  // namespace lapis::slam
