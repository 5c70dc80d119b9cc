#pragma once

#include <string>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Reads a PLY file whose faces have class_id and instance_id, with beside it classes.csv (class_id, class) and
/// instances.csv (instance_id, class_id, name). World frame, z up, metres. The colours are those of the faces, of the
/// vertices, or of the classes.
///
/// Where instances.csv also has the columns model and m00..m23 (3x4, model to world, row by row) and there is a
/// models/MODEL.obj, that model shows the instance, provided that it is the same surface: as many triangles, and a box
/// that agrees within 1 mm.
///
/// The faces decide the class: an instance of which parts have another class than instances.csv says is divided, with a
/// warning. Faces with instance 0 belong to no thing; one instance per class holds them.
/// @throws std::runtime_error in one line with the remedy for files that are missing or do not fit together.
Scene load_labelled_ply(const AssetStore& store, const std::string& ply_name, const LoadOptions& options);

}  // namespace lapis::simulator
