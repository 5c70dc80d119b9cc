#pragma once

namespace lapis::simulator {

/// How hard localisation is: camera images and odometry get worse together.
enum class DriftPreset { kNominal, kHard };

/// The changes that a drift preset makes.
struct DriftScales {
  double texture = 1.0;   ///< factor on the contrast of colour images (ColorNoiseConfig::contrast)
  double dropout = 0.0;   ///< additional share of depth pixels without depth (DepthNoiseConfig::extra_dropout)
  double blur = 0.0;      ///< share of the time between frames that the shutter is open (ColorNoiseConfig::shutter)
  double depth = 1.0;     ///< factor on the standard deviations of depth (DepthNoiseConfig::noise_multiplier)
  double odometry = 1.0;  ///< factor on all standard deviations of wheel odometry (OdometryNoiseConfig::scale)
};

/// kHard gives slam without loop closures and without odometry an ATE of 15 to 30 cm on the tour of large_building
/// (docs/decisions/0019-what-hard-drift-is.md).
constexpr DriftScales drift_scales(DriftPreset preset) {
  if (preset == DriftPreset::kHard)
    return {.texture = 0.9, .dropout = 0.05, .blur = 0.2, .depth = 3.7, .odometry = 3.0};
  return {};
}

}  // namespace lapis::simulator
