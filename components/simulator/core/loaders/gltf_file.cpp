#include "simulator/core/loaders/gltf_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "simulator/core/assets/text_scan.hpp"
#include "simulator/core/loaders/json_file.hpp"
#include "simulator/core/loaders/scene_assembly.hpp"
#include "simulator/core/loaders/uri.hpp"

namespace lapis::simulator {
namespace {

constexpr std::size_t kNoItem = std::numeric_limits<std::size_t>::max();

// Values of componentType [section 3.6.2.2].
enum : std::size_t { kByte = 5120, kUnsignedByte, kShort, kUnsignedShort, kUnsignedInt = 5125, kFloat = 5126 };

std::size_t component_size(std::size_t type) {
  switch (type) {
    case kByte:
    case kUnsignedByte: return 1;
    case kShort:
    case kUnsignedShort: return 2;
    case kUnsignedInt:
    case kFloat: return 4;
    default: return 0;
  }
}

std::size_t component_count(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 0;
}

template <class Number>
Number read_little_endian(std::span<const std::uint8_t> bytes, std::size_t at) {
  static_assert(std::endian::native == std::endian::little);
  Number value;
  std::memcpy(&value, bytes.subspan(at, sizeof(Number)).data(), sizeof(Number));
  return value;
}

// Normalised integers stand for 0..1 or -1..1 [section 3.6.2.2, equations for normalised integers].
template <class Number>
double read_integer(std::span<const std::uint8_t> bytes, std::size_t at, bool is_normalized) {
  const auto value = static_cast<double>(read_little_endian<Number>(bytes, at));
  if (!is_normalized) return value;
  return std::max(value / static_cast<double>(std::numeric_limits<Number>::max()), -1.0);
}

}  // namespace

GltfFile::GltfFile(const AssetStore& store, const std::string& name)
    : store_(store), folder_(std::filesystem::path(name).parent_path().generic_string()),
      file_(full_name(store, name)) {
  if (!folder_.empty()) folder_ += '/';
  const auto bytes = read_required(store, name);
  constexpr std::string_view kMagic = "glTF";
  const std::string_view text = as_text(bytes);
  if (text.substr(0, kMagic.size()) == kMagic) {
    read_binary(bytes);
  } else {
    root_ = parse_json_object(text, file_);
  }
  const std::string version = text_member(member(root_, "asset"), "version", file_);
  if (version.empty() || version[0] != '2') {
    fail("glTF version '" + version.substr(0, 20) + "' is not read; export it as glTF 2.0");
  }
  read_buffers(store);
}

void GltfFile::fail(const std::string& what) const { throw std::runtime_error(file_ + ": " + what); }

const nlohmann::json& GltfFile::item(const char* array, std::size_t index) const {
  const auto& items = array_member(root_, array, file_);
  if (index >= items.size()) {
    fail("there is no " + std::string(array) + "[" + std::to_string(index) + "]; export the file again");
  }
  return items[index];
}

// Header and chunks of a .glb [section 4.4].
void GltfFile::read_binary(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  constexpr const char* kTruncated = "the GLB file is truncated; copy or download it again";
  if (bytes.size() < kHeader || read_little_endian<std::uint32_t>(bytes, 8) > bytes.size()) fail(kTruncated);
  bool has_json = false;
  std::size_t at = kHeader;
  while (at + kChunkHeader <= bytes.size()) {
    const std::size_t size = read_little_endian<std::uint32_t>(bytes, at);
    const auto type = read_little_endian<std::uint32_t>(bytes, at + 4);
    at += kChunkHeader;
    if (size > bytes.size() - at) fail(kTruncated);
    const auto chunk = bytes.subspan(at, size);
    if (type == kJson && !has_json) {
      root_ = parse_json_object({reinterpret_cast<const char*>(chunk.data()), chunk.size()}, file_);
      has_json = true;
    } else if (type == kBinary && binary_.empty()) {
      binary_.assign(chunk.begin(), chunk.end());
    }
    at += size;
  }
  if (!has_json) fail(kTruncated);
}

void GltfFile::read_buffers(const AssetStore& store) {
  const auto& list = array_member(root_, "buffers", file_);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string uri = text_member(list[i], "uri", file_);
    const std::size_t length = index_member(list[i], "byteLength", file_, 0);
    bool is_found = true;
    std::vector<std::uint8_t> bytes;
    if (uri.empty() && i == 0) {
      bytes = std::move(binary_);
    } else {
      bytes = resolve(store, uri, is_found);
    }
    const std::string name = "buffer " + std::to_string(i) + (uri.empty() ? "" : " ('" + uri.substr(0, 60) + "')");
    if (!is_found) fail(name + " is not there; put it beside the file");
    if (bytes.size() < length) {
      fail(name + " has " + std::to_string(bytes.size()) + " bytes, not the " + std::to_string(length) +
           " it should have; copy or download it again");
    }
    buffers_.push_back(std::move(bytes));
  }
}

std::vector<std::uint8_t> GltfFile::resolve(const AssetStore& store, const std::string& uri, bool& is_found) const {
  auto bytes = decode_data_uri(uri);
  if (!bytes && !uri.empty()) bytes = store.read(folder_ + decode_percent(uri));
  is_found = bytes.has_value();
  return std::move(bytes).value_or(std::vector<std::uint8_t>{});
}

GltfFile::View GltfFile::view(std::size_t index) const {
  const auto& json = item("bufferViews", index);
  const std::size_t buffer = index_member(json, "buffer", file_, kNoItem);
  const std::size_t offset = index_member(json, "byteOffset", file_, 0);
  const std::size_t length = index_member(json, "byteLength", file_, 0);
  const bool is_inside =
      buffer < buffers_.size() && offset <= buffers_[buffer].size() && length <= buffers_[buffer].size() - offset;
  if (!is_inside) fail("bufferViews[" + std::to_string(index) + "] leaves its buffer; export the file again");
  return {std::span(buffers_[buffer]).subspan(offset, length), index_member(json, "byteStride", file_, 0)};
}

GltfFile::Numbers GltfFile::numbers(std::size_t accessor) const {
  const auto& json = item("accessors", accessor);
  const std::string name = "accessors[" + std::to_string(accessor) + "]";
  if (!member(json, "sparse").is_null() || member(json, "bufferView").is_null()) {
    fail(name + " is sparse, which is not read; export without sparse accessors");
  }
  const View source = view(index_member(json, "bufferView", file_, kNoItem));
  Numbers result;
  result.type = index_member(json, "componentType", file_, 0);
  result.size = component_size(result.type);
  result.width = component_count(text_member(json, "type", file_));
  result.count = index_member(json, "count", file_, 0);
  result.is_normalized = member(json, "normalized") == true;
  const std::size_t element = result.size * result.width;
  if (element == 0) fail(name + " has a type that is not read; export the file again");
  result.stride = source.stride == 0 ? element : source.stride;
  const std::size_t offset = index_member(json, "byteOffset", file_, 0);
  const std::size_t available = offset <= source.bytes.size() ? source.bytes.size() - offset : 0;
  const bool is_inside =
      result.stride >= element &&
      (result.count == 0 || (available >= element && result.count - 1 <= (available - element) / result.stride));
  if (!is_inside) fail(name + " leaves its buffer view; export the file again");
  result.bytes = source.bytes.subspan(std::min(offset, source.bytes.size()));
  return result;
}

double GltfFile::component(const Numbers& numbers, std::size_t element, std::size_t index) const {
  const std::size_t at = element * numbers.stride + index * numbers.size;
  switch (numbers.type) {
    case kByte: return read_integer<std::int8_t>(numbers.bytes, at, numbers.is_normalized);
    case kUnsignedByte: return read_integer<std::uint8_t>(numbers.bytes, at, numbers.is_normalized);
    case kShort: return read_integer<std::int16_t>(numbers.bytes, at, numbers.is_normalized);
    case kUnsignedShort: return read_integer<std::uint16_t>(numbers.bytes, at, numbers.is_normalized);
    case kUnsignedInt: return read_integer<std::uint32_t>(numbers.bytes, at, false);
    default: return static_cast<double>(read_little_endian<float>(numbers.bytes, at));
  }
}

template <std::size_t Width>
std::vector<std::array<float, Width>> GltfFile::vectors(std::size_t accessor) const {
  const Numbers source = numbers(accessor);
  if (source.width != Width) {
    fail("accessors[" + std::to_string(accessor) + "] should have " + std::to_string(Width) +
         " components; export the file again");
  }
  std::vector<std::array<float, Width>> result(source.count);
  for (std::size_t i = 0; i < source.count; ++i) {
    for (std::size_t k = 0; k < Width; ++k) result[i][k] = static_cast<float>(component(source, i, k));
  }
  return result;
}
template std::vector<std::array<float, 2>> GltfFile::vectors<2>(std::size_t) const;
template std::vector<std::array<float, 3>> GltfFile::vectors<3>(std::size_t) const;
template std::vector<std::array<float, 4>> GltfFile::vectors<4>(std::size_t) const;

std::vector<std::uint32_t> GltfFile::indices(std::size_t accessor) const {
  const Numbers source = numbers(accessor);
  const bool is_whole = source.type == kUnsignedByte || source.type == kUnsignedShort || source.type == kUnsignedInt;
  if (source.width != 1 || !is_whole || source.is_normalized) {
    fail("accessors[" + std::to_string(accessor) + "] should hold indices; export the file again");
  }
  std::vector<std::uint32_t> result(source.count);
  for (std::size_t i = 0; i < source.count; ++i) result[i] = static_cast<std::uint32_t>(component(source, i, 0));
  return result;
}

std::vector<std::uint8_t> GltfFile::image(std::size_t index) const {
  const auto& json = item("images", index);
  if (!member(json, "bufferView").is_null()) {
    const auto bytes = view(index_member(json, "bufferView", file_, kNoItem)).bytes;
    return {bytes.begin(), bytes.end()};
  }
  bool is_found = false;
  return resolve(store_, text_member(json, "uri", file_), is_found);
}

}  // namespace lapis::simulator
