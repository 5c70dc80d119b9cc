#pragma once

#include <vector>

#include "simulator/core/noise/random.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

struct RoundTrip {
  std::vector<Eigen::Vector2d> waypoints;  ///< [m]; the last one is the first one again
  std::vector<StartPose> starts;
};

/// Plans a tour through places with room around them in all rooms (several places in large rooms), which always goes on
/// to the nearest place that is left, and up to five starts at such places, which look along the longest free line.
/// Furniture counts as boxes of its size.
/// @param spec its items on other items (OnItem) are ignored, as they are in nobody's way
/// @throws std::runtime_error naming building and room when a room has no place, or none that can be reached
RoundTrip plan_round_trip(const SceneSpec& spec, const Random& random);

}  // namespace lapis::simulator
