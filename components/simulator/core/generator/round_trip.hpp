#pragma once

#include <vector>

#include "simulator/core/noise/random.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

struct RoundTrip {
  std::vector<Eigen::Vector2d> waypoints;  ///< the last one is the first start
  std::vector<StartPose> starts;
};

/// Places with room around them in all rooms, several in large ones, nearest first; and up to five starts among them
/// that look along the longest free line. Knows furniture by the boxes of its size.
/// @param spec without OnItem places that matter: what stands on something is in nobody's way
/// @throws std::runtime_error naming building and room when a room has no place, or none that can be reached
RoundTrip plan_round_trip(const SceneSpec& spec, const Random& random);

}  // namespace lapis::simulator
