#pragma once

namespace lapis::simulator {

/// How hard it is to stay localised: visual difficulty and wheel noise change together.
enum class DriftPreset { kNominal, kHard };

/// What a drift preset changes.
struct DriftScales {
  double texture = 1.0;  ///< factor on the contrast of colour images (ColorNoiseConfig::contrast)
  double dropout = 0.0;  ///< additional share of depth pixels without depth (DepthNoiseConfig::extra_dropout)
  double blur = 0.0;     ///< share of the time between frames that the shutter is open (ColorNoiseConfig::shutter)
  double wheel = 1.0;    ///< factor on all standard deviations of wheel odometry (WheelNoiseConfig::scale)
};

/// The values of kHard are tentative until they are calibrated on the tour of large_building.
constexpr DriftScales drift_scales(DriftPreset preset) {
  if (preset == DriftPreset::kHard) return {.texture = 0.5, .dropout = 0.3, .blur = 0.5, .wheel = 3.0};
  return {};
}

}  // namespace lapis::simulator
