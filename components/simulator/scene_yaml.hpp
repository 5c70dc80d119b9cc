#pragma once

#include <filesystem>

#include "common/mapping/model/label_list.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

/// Reads a scene file; docs/scenes.md describes it. Its labels come from the file that it names, by default from
/// ../labels/mpcat40.yaml relative to its own folder.
/// @throws std::runtime_error naming file and line for what is missing, unknown, or of the wrong kind. build_scene
///   checks whether the building makes sense.
/// @param usual_labels label file that is used when the scene file names none and the default one does not exist
SceneSpec read_scene_yaml(const std::filesystem::path& file, const std::filesystem::path& usual_labels = {});

/// Reads the waypoints of a tour: "tour: [[x, y], ...]".
/// @throws std::runtime_error naming file and line
std::vector<Eigen::Vector2d> read_tour_yaml(const std::filesystem::path& file);

}  // namespace lapis::simulator
