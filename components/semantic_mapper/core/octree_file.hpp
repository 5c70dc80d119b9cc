#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/geometry/image.hpp"
#include "common/mapping/model/voxel_index.hpp"

namespace lapis::semantic_mapper {

/// A cube of voxels with the same content.
struct OctreeLeaf {
  mapping::VoxelIndex corner;    ///< its voxel of least x, y, z; (0, 0, 0) begins at the origin of the map frame
  std::int32_t edge_voxels = 1;  ///< a power of two
  bool is_occupied = false;
  double probability = 0.0;  ///< P(occupied); only 0 or 1 from a .bt file
  geometry::Rgb8 color{};    ///< of a ColorOcTree; grey otherwise
};

/// Content of an OctoMap file, written by Lapis or by others.
struct OctreeFile {
  std::string kind;  ///< "OcTree" or "ColorOcTree"
  bool is_binary = false;
  double resolution_m = 0.0;
  std::size_t nodes = 0;  ///< inner nodes and leaves
  std::vector<OctreeLeaf> leaves;
};

/// Reads the bytes of a .bt file (OcTree) or of a .ot file (OcTree, ColorOcTree). Nothing, with the reason in `error`,
/// for anything that is not whole. Unlike liboctomap, it does not trust its input: it checks depth and number of nodes.
std::optional<OctreeFile> decode_octree(std::span<const std::uint8_t> bytes, std::string& error);

}  // namespace lapis::semantic_mapper
