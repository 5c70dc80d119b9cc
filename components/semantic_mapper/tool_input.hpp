#pragma once

#include <string>
#include <variant>

#include "common/mapping/file/map_file.hpp"
#include "semantic_mapper/core/octree_file.hpp"

namespace lapis::semantic_mapper {

/// Content of a file given to a tool: Lapis' own map, or an octree of OctoMap.
using ToolInput = std::variant<mapping::MapFile, OctreeFile>;

/// Lower-case extension with its dot; empty when there is none.
std::string extension_of(const std::string& path);

/// Reads a .lapis, .ot or .bt file. Throws std::runtime_error that names the file.
ToolInput read_input(const std::string& path);

/// Reads a .lapis file. Throws std::runtime_error that names the file.
mapping::MapFile read_map(const std::string& path);

}  // namespace lapis::semantic_mapper
