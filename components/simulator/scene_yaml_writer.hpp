#pragma once

#include <string>

#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

/// A scene file that read_scene_yaml reads as `spec`, when its lengths are whole centimetres and its angles whole
/// degrees. Labels are not named: the usual ones.
std::string to_scene_yaml(const SceneSpec& spec);

}  // namespace lapis::simulator
