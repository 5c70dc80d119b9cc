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

/// Reads the instances by their colour, 0xRRGGBB. @throws std::runtime_error naming `file` and line.
std::map<std::uint32_t, Hm3dInstance> parse_hm3d_instances(std::string_view text, const std::string& file);

/// Reads the mapping from raw category to mpcat40 class: the columns raw_category and mpcat40 of
/// hm3dsem_category_mappings.tsv.
/// @throws std::runtime_error naming `file` when a column is missing.
std::map<std::string, std::string> parse_hm3d_mapping(std::string_view text, const std::string& file);

/// Reads ID.semantic.glb and ID.semantic.txt. A triangle belongs to the instance whose colour it has: the most frequent
/// colour of seven texels of its texture or, without a texture, of its vertices; colours are never mixed. ID.glb gives
/// the appearance if it has the same triangles in the same order; otherwise the colours of the instances are shown,
/// with a warning. z is up, as in the files of the data set.
/// @param mapping from raw category to class; without it, the raw categories are the classes
/// @throws std::runtime_error with one line that names the remedy.
Scene load_hm3d(const AssetStore& store, const std::string& id,
                const std::optional<std::map<std::string, std::string>>& mapping, const LoadOptions& options);

}  // namespace lapis::simulator
