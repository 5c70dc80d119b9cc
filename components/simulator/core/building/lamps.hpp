#pragma once

#include <vector>

#include "simulator/core/scene/scene.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

/// The lamps of a normalised spec; when it names none, each room has one per 12 m2, spread over its floor.
std::vector<LampSpec> lamps_of(const SceneSpec& spec);

/// Adds a light, and the lamp from which it comes, which hangs from the ceiling.
void add_lamp(Scene& scene, const SceneSpec& spec, const LampSpec& lamp);

}  // namespace lapis::simulator
