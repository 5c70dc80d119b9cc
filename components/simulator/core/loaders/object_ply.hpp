#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Class and name of an object to which faces refer by its number.
struct ObjectLabel {
  std::uint16_t class_id = 0;
  std::string name;
};

/// Reads mesh and instances from a PLY file whose faces have object_id, as those of Matterport3D and Replica: z up,
/// metres, colours of the vertices (grey without). Instance ids are object ids plus 1. Only objects that have faces
/// become instances; faces of objects that are not in `objects` are unlabelled, and one warning counts these objects,
/// except those with negative ids.
/// @throws std::runtime_error as read_ply(), and when an id is too large.
Scene load_object_ply(std::span<const std::uint8_t> bytes, const std::string& file,
                      const std::map<std::int64_t, ObjectLabel>& objects);

}  // namespace lapis::simulator
