#pragma once

#include <vector>

#include "simulator/core/building/floor_plan.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {

/// Convex pieces of floor into which jitter moves nothing: in front of doors and passages, around the starts, and
/// along the straight lines between the waypoints of the bundled tour.
/// @param spec normalised
std::vector<Polygon> keep_clear(const SceneSpec& spec, const std::vector<RoomPlan>& plan);

}  // namespace lapis::simulator
