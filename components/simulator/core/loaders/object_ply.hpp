#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// What a data set says about an object that faces name by its number.
struct ObjectLabel {
  std::uint16_t class_id = 0;
  std::string name;
};

/// Mesh and instances from a PLY file whose faces have object_id, as Matterport3D and Replica have them: z up, metres,
/// colours of the vertices (grey without). Instance ids are object ids plus 1. Only objects that have faces become
/// instances; faces of objects that `objects` has not are unlabelled, with one warning unless the id is negative.
/// @throws std::runtime_error as read_ply(), and when an id is too large.
Scene load_object_ply(std::span<const std::uint8_t> bytes, const std::string& file,
                      const std::map<std::int64_t, ObjectLabel>& objects);

}  // namespace lapis::simulator
