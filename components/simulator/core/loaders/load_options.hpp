#pragma once

#include "common/mapping/model/label_list.hpp"

namespace lapis::simulator {

/// Options of the loaders of users' own scenes.
struct LoadOptions {
  mapping::LabelList labels;  ///< classes that scenes may name, such as mpcat40; empty: the scene's own
  int max_texture_px = 2048;  ///< longer side; larger textures are shrunk
};

}  // namespace lapis::simulator
