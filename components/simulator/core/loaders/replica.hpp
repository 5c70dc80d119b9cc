#pragma once

#include <string>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Reads mesh_semantic.ply (z up, metres; polygons with object_id, coloured vertices) and info_semantic.json
/// ({"classes": [{"id", "name"}], "objects": [{"id", "class_id"}]}) of the Replica data set from `folder` of the store
/// (with '/' at its end, or empty). The labels are the classes of that file. Instance ids are object ids plus 1.
/// @throws std::runtime_error with one line that names the remedy.
Scene load_replica(const AssetStore& store, const std::string& folder);

}  // namespace lapis::simulator
