#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "simulator/core/assets/asset_store.hpp"

namespace lapis::simulator {

/// The container of a glTF 2.0 scene, .gltf or .glb: its JSON text and the numbers and bytes that it points to, all
/// checked [Khronos, glTF 2.0 Specification, sections 3.6 and 4.4]. Errors are std::runtime_error with one line that
/// names the file.
class GltfFile {
 public:
  /// Reads the file and, from the same store, the buffers that it names.
  GltfFile(const AssetStore& store, const std::string& name);

  const nlohmann::json& root() const { return root_; }
  const std::string& description() const { return file_; }
  /// Element `index` of the array `array` of the root.
  const nlohmann::json& item(const char* array, std::size_t index) const;

  /// Values of an accessor of vectors with `Width` components; normalised integers become fractions.
  template <std::size_t Width>
  std::vector<std::array<float, Width>> vectors(std::size_t accessor) const;
  /// Values of an accessor of single integers.
  std::vector<std::uint32_t> indices(std::size_t accessor) const;
  /// Content of an image, encoded as in the file; empty when the image is in a file that is missing.
  std::vector<std::uint8_t> image(std::size_t index) const;

  [[noreturn]] void fail(const std::string& what) const;

 private:
  struct View {
    std::span<const std::uint8_t> bytes;
    std::size_t stride = 0;  ///< 0: packed
  };
  struct Numbers {
    std::span<const std::uint8_t> bytes;  ///< from the first element on
    std::size_t count = 0, width = 0, stride = 0, size = 0;
    std::size_t type = 0;  ///< componentType
    bool is_normalized = false;
  };

  void read_binary(std::span<const std::uint8_t> bytes);
  void read_buffers(const AssetStore& store);
  std::vector<std::uint8_t> resolve(const AssetStore& store, const std::string& uri, bool& is_found) const;
  View view(std::size_t index) const;
  Numbers numbers(std::size_t accessor) const;
  double component(const Numbers& numbers, std::size_t element, std::size_t index) const;

  const AssetStore& store_;
  std::string folder_;  ///< of the file in the store; ends with '/', or is empty
  std::string file_;
  nlohmann::json root_;
  std::vector<std::uint8_t> binary_;  ///< the BIN chunk of a .glb
  std::vector<std::vector<std::uint8_t>> buffers_;
};

}  // namespace lapis::simulator
