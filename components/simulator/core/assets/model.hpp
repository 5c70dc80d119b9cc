#pragma once

#include <string>
#include <vector>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// A model as its file has it: own units and axes. Triangle::part indexes `groups`.
struct Model {
  Mesh mesh;
  std::vector<std::string> groups;    ///< OBJ groups or glTF nodes; at least one
  std::vector<std::string> warnings;  ///< a texture that is missing, faces that were left out, ...; one line each
};

}  // namespace lapis::simulator
