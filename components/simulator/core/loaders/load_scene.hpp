#pragma once

#include <filesystem>

#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Reads a user's own building; the names of the files decide how. `path` is the folder, or one of these files in it
/// (the file, when the folder holds several scenes). In a folder, scene_labelled.ply comes first, then, in this order:
///
/// | files | layout |
/// | --- | --- |
/// | ID.house, ID_semantic.ply | Matterport3D, see load_matterport() |
/// | ID.semantic.glb, ID.semantic.txt | HM3D, see load_hm3d() |
/// | mesh_semantic.ply, info_semantic.json, also in a folder habitat | Replica, see load_replica() |
/// | NAME.obj, NAME.glb or NAME.gltf, semantics.json | see load_model_scene() |
/// | NAME.ply, instances.csv, classes.csv | see load_labelled_ply() |
///
/// @throws std::runtime_error with one line that names the file and the remedy.
Scene load_scene(const std::filesystem::path& path, const LoadOptions& options);

}  // namespace lapis::simulator
