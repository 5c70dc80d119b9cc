#include "semantic_mapper/tool_input.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>

#include "common/files/atomic_file.hpp"

namespace lapis::semantic_mapper {

std::string extension_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

ToolInput read_input(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == ".lapis") return read_map(path);
  if (extension != ".ot" && extension != ".bt")
    throw std::runtime_error(path + ": cannot be read as a map; expected .lapis, .ot or .bt");
  std::string error;
  const auto bytes = files::read_file(path, error);
  if (!bytes) throw std::runtime_error(error);
  auto octree = decode_octree(*bytes, error);
  if (!octree) throw std::runtime_error(path + ": " + error);
  return std::move(*octree);
}

mapping::MapFile read_map(const std::string& path) {
  std::string error;
  auto file = mapping::load_map(path, error);
  if (!file) throw std::runtime_error(error);
  return std::move(*file);
}

}  // namespace lapis::semantic_mapper
