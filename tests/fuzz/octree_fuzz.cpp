// Octrees of OctoMap: .bt and .ot.

#include <cstddef>
#include <cstdlib>

#include "semantic_mapper/core/octree_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string error;
  const auto file = lapis::semantic_mapper::decode_octree({data, size}, error);
  if (file.has_value() != error.empty()) std::abort();
  if (file && file->leaves.size() > file->nodes) std::abort();
  return 0;
}
