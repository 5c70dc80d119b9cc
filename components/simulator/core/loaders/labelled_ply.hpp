#pragma once

#include <string>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// Reads a PLY file whose faces have class_id and instance_id, and beside it classes.csv (class_id, class) and
/// instances.csv (instance_id, class_id, name). The frame is the world's: z up, metres. The colours are those of the
/// faces or, failing that, of the vertices or of the classes.
///
/// When instances.csv also has the columns model and m00..m23 (3x4, model to world, row by row) and there is a
/// models/MODEL.obj, that model gives the appearance of the instance, provided that it is the same surface: it has as
/// many triangles, and a bounding box that agrees within 1 mm.
///
/// The faces decide the class: parts of an instance that have another class than in instances.csv become instances of
/// their own, with a warning. Faces with instance 0 belong to no thing; one additional instance per class holds them.
/// @throws std::runtime_error with one line that names the remedy, for files that are missing or inconsistent.
Scene load_labelled_ply(const AssetStore& store, const std::string& ply_name, const LoadOptions& options);

}  // namespace lapis::simulator
