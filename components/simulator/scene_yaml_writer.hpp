#pragma once

#include <string>

#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

/// Text of a scene file from which read_scene_yaml reads `spec`, provided that its lengths are whole centimetres and
/// its angles whole degrees. The file names no labels, so the default ones apply.
std::string to_scene_yaml(const SceneSpec& spec);

}  // namespace lapis::simulator
