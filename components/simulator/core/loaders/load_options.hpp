#pragma once

#include "common/mapping/model/label_list.hpp"

namespace lapis::simulator {

/// What the loaders of users' own scenes may be given.
struct LoadOptions {
  mapping::LabelList labels;  ///< the classes that scenes name, such as mpcat40; empty: the scene's own names
  int max_texture_px = 2048;  ///< longer side; larger textures are shrunk
};

}  // namespace lapis::simulator
