#pragma once

#include "simulator/core/generator/building_kind.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

/// Generates a furnished building with starts and a tour through all rooms: a pure function of its arguments. Rooms
/// that are copies have equal furniture and pictures, which jitter never moves. Unless the name asks for panes, no
/// glass and no mirror stands free: glass is in windows with a sill, and mirrors hang on walls.
/// @param labels has the classes of mpcat40
SceneSpec generate_building(const BuildingName& name, const mapping::LabelList& labels);

}  // namespace lapis::simulator
