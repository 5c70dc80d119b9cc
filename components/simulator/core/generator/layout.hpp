#pragma once

#include "simulator/core/generator/building_kind.hpp"
#include "simulator/core/generator/building_plan.hpp"

namespace lapis::simulator {

/// Draws rooms, doors and windows of a building: a pure function of its name. The building as a whole is rotated by a
/// random multiple of 90 degrees, and mirrored or not.
BuildingPlan lay_out(const BuildingName& name);

}  // namespace lapis::simulator
