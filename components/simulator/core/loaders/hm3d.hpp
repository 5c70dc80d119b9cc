#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// A line of ID.semantic.txt: id,RRGGBB,"category",region
struct Hm3dInstance {
  std::int64_t id = 0;
  std::string category;
};

/// Instances by their colour, 0xRRGGBB. @throws std::runtime_error naming `file` and line.
std::map<std::uint32_t, Hm3dInstance> parse_hm3d_instances(std::string_view text, const std::string& file);

/// From raw category to mpcat40 class: the columns raw_category and mpcat40 of hm3dsem_category_mappings.tsv.
/// @throws std::runtime_error naming `file` when they are not there.
std::map<std::string, std::string> parse_hm3d_mapping(std::string_view text, const std::string& file);

/// Reads ID.semantic.glb and ID.semantic.txt. A triangle belongs to the instance whose colour it has: that of most of
/// seven texels below it, of the vertices where there is no texture; no colour is ever mixed. ID.glb gives the looks if
/// it has the same triangles in the same order; else a warning says that the colours of the instances are shown. z is
/// up, as in the files of the data set.
/// @param mapping from raw category to class; nothing: the raw categories are the classes
/// @throws std::runtime_error in one line with the remedy.
Scene load_hm3d(const AssetStore& store, const std::string& id,
                const std::optional<std::map<std::string, std::string>>& mapping, const LoadOptions& options);

}  // namespace lapis::simulator
