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

/// Content of semantics.json, which labels the model beside it:
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
    std::optional<std::string> node;      ///< "node" of glTF, with all nodes below it, or "group" of OBJ
    std::optional<std::string> material;  ///< when there is a node as well, both must match
  };
  std::vector<Entry> instances;
  mapping::LabelList labels;  ///< empty when the file has none
  UpAxis up = UpAxis::kY;
};

/// Reads a semantics.json. @throws std::runtime_error with one line that names `file` and the entry.
Semantics parse_semantics(std::string_view text, const std::string& file);

/// Reads an .obj, .gltf or .glb file with the semantics.json beside it. A triangle belongs to the first entry that
/// matches; failing that, in glTF, to its own or the nearest higher node with extras.class; failing that, to no
/// instance. The classes are those of "labels", failing that those of the options, and failing that all that are named.
/// The axis that points up is "up", by default y. Without semantics.json and extras.class nothing is labelled, with a
/// warning.
/// @throws std::runtime_error with one line that names the remedy.
Scene load_model_scene(const AssetStore& store, const std::string& name, const LoadOptions& options);

}  // namespace lapis::simulator
