#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "simulator/core/scene/scene.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

struct BuildOptions {
  std::uint64_t seed = 0;         ///< of the jitter, and of the choice of pictures that are left out
  bool with_jitter = true;        ///< up to 5 cm and 10 degrees for movable items, 10 cm along the wall for pictures
  double texture_richness = 1.0;  ///< 0 to 2: contrast of walls, floors, ceilings and pictures
  double pictures_density = 1.0;  ///< 0 to 1: share of the pictures that hang
};

/// A model for a piece of furniture, in the item frame (see parametric_furniture.hpp), at its natural size.
struct SourcedModel {
  Mesh mesh;                        ///< Triangle::part is an index into `groups`
  std::vector<std::string> groups;  ///< names that FurnitureSpec::parts may use, beside those of materials
  double elevation_m = 0.0;         ///< usual height of its lowest point above the floor
  std::optional<Credit> credit;
  std::vector<std::string> warnings;  ///< one line each
};

/// The reason why there is no model, in one line, which becomes a warning of the scene.
struct SourceRefusal {
  std::string reason;
};

/// Finds the model of an item; it is called only for items that name one. It is empty when there is no catalogue.
using FurnitureSource = std::function<std::variant<SourcedModel, SourceRefusal>(const FurnitureSpec&)>;

/// Builds the rooms of a spec and furnishes them. Furniture without a model, or whose model is not available, is made
/// of simple shapes, with the size of the spec or, failing that, of its class; each cause of a missing model gives one
/// warning of the scene. The result is a function of the arguments alone.
/// @throws std::runtime_error with one line that names the scene's file and the item that makes no sense
Scene build_scene(const SceneSpec& spec, const FurnitureSource& furniture, const BuildOptions& options = {});

}  // namespace lapis::simulator
