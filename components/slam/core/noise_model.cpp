#include "slam/core/noise_model.hpp"

#include <cmath>

namespace lapis::slam {

double depth_sigma(const NoiseConfig& config, double depth_m) {
  return config.depth_sigma_m + config.depth_sigma_per_m * depth_m * depth_m;
}

bool is_depth(const NoiseConfig& config, double depth_m) {
  return std::isfinite(depth_m) && depth_m >= config.min_depth_m && depth_m <= config.max_depth_m;
}

}  // namespace lapis::slam
