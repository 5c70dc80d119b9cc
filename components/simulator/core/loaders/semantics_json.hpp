#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

enum class UpAxis { kY, kZ };

/// What semantics.json says about the model beside it:
///
///     {"instances": [{"id": 1, "class": "chair", "node": "Chair.001"}, {"id": 2, "class": "wall", "material":
///     "paint"}],
///      "labels": [{"id": 1, "name": "wall"}, {"id": 2, "name": "chair"}], "up": "z"}
///
/// "labels" may also be a list of names, numbered from 1; "labels" and "up" may be left out.
struct Semantics {
  struct Entry {
    std::int64_t id = 0;
    std::string class_name;
    std::string name;                     ///< of the instance; default: node, group or material
    std::optional<std::string> node;      ///< "node" of glTF or "group" of OBJ; what hangs below the node belongs to it
    std::optional<std::string> material;  ///< with a node as well, both must fit
  };
  std::vector<Entry> instances;
  mapping::LabelList labels;  ///< empty when the file has none
  UpAxis up = UpAxis::kY;
};

/// @throws std::runtime_error naming `file` and the entry in one line.
Semantics parse_semantics(std::string_view text, const std::string& file);

/// Reads an .obj, .gltf or .glb file with the semantics.json beside it. A triangle belongs to the first entry that
/// fits; else, in glTF, to the nearest node above it with extras.class; else to nothing. The classes are those of
/// "labels", of the options, or, when both are empty, all that are named. Up is "up", else y. Without semantics.json
/// and extras.class nothing is labelled, with a warning.
/// @throws std::runtime_error in one line with the remedy.
Scene load_model_scene(const AssetStore& store, const std::string& name, const LoadOptions& options);

}  // namespace lapis::simulator
