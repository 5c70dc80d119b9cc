#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

/// What an MTL file says about a material, as far as it can be seen.
struct MtlMaterial {
  geometry::Rgb8 color{204, 204, 204};  ///< Kd; where there is none, what modellers show by default
  float opacity = 1.0F;                 ///< d, or 1 - Tr
  std::string texture;                  ///< file name in map_Kd as written there, without options; empty: none
};

/// Materials by name. Lines that make no sense are ignored.
std::map<std::string, MtlMaterial, std::less<>> parse_mtl(std::string_view text);

}  // namespace lapis::simulator
