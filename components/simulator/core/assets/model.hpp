#pragma once

#include <string>
#include <vector>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// A model in the units and axes of its file. Triangle::part is an index into `groups`.
struct Model {
  Mesh mesh;
  std::vector<std::string> groups;    ///< OBJ groups or glTF nodes; at least one
  std::vector<std::string> warnings;  ///< missing textures, faces that were left out, ...; one line each
};

}  // namespace lapis::simulator
