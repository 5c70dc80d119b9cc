#pragma once

#include <optional>

#include "common/mapping/label_list.hpp"

namespace lapis::simulator {

enum class UpAxis { kY, kZ };

/// What the loaders of users' own scenes may be told.
struct LoadOptions {
  mapping::LabelList labels;  ///< the classes that scenes name, such as mpcat40; empty: the scene's own names
  std::optional<UpAxis> up;   ///< of the files; default: what the layout has
  int max_texture_px = 2048;  ///< longer side; larger textures are shrunk
};

}  // namespace lapis::simulator
