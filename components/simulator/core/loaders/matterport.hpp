#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// The objects and their classes in a .house file of Matterport3D.
struct House {
  struct Category {
    std::string name;     ///< as the annotators wrote it
    std::string mpcat40;  ///< the class
  };
  std::map<std::int64_t, Category> categories;
  std::map<std::int64_t, std::int64_t> category_of_object;  ///< -1: none
  std::vector<std::string> warnings;
};

/// Reads the header and the records O and C of "ASCII 1.1" [Matterport3D, data_organization.md], and skips the others.
/// @throws std::runtime_error naming `file` and line.
House parse_house(std::string_view text, const std::string& file);

/// Reads ID_semantic.ply (z up, metres; faces with object_id) and ID.house. Instance ids are object ids plus 1. The
/// colours are those of the vertices; a warning says that the textures of ID.glb are not used.
/// @throws std::runtime_error with one line that names the remedy.
Scene load_matterport(const AssetStore& store, const std::string& id, const LoadOptions& options);

}  // namespace lapis::simulator
