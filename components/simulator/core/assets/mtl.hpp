#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

/// The visible properties of a material in an MTL file.
struct MtlMaterial {
  geometry::Rgb8 color{204, 204, 204};  ///< Kd; without one, the grey that modelling programs show
  float opacity = 1.0F;                 ///< d, or 1 - Tr
  std::string texture;                  ///< file name of map_Kd as it is written, without options; empty: none
};

/// Materials by name. Lines that make no sense are ignored.
std::map<std::string, MtlMaterial, std::less<>> parse_mtl(std::string_view text);

}  // namespace lapis::simulator
