#include "simulator/core/assets/image_data.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace lapis::simulator {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::int64_t kMaxPixels = 8192LL * 8192;

struct Size {
  std::int64_t width = 0, height = 0;
};

std::int64_t big_endian(Bytes bytes, std::size_t at, std::size_t count) {
  std::int64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = value << 8 | bytes[at + i];
  return value;
}

std::int64_t little_endian_i32(Bytes bytes, std::size_t at) {
  std::int32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= static_cast<std::int32_t>(std::uint32_t{bytes[at + i]} << (8 * i));
  return value;
}

bool starts_with(Bytes bytes, std::initializer_list<std::uint8_t> magic) {
  return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
}

// Walks over the segments to the frame header (SOFn), which holds height and width [ITU T.81, B.2.2].
std::optional<Size> jpeg_size(Bytes bytes) {
  std::size_t at = 2;
  while (at + 9 <= bytes.size() && bytes[at] == 0xFF) {
    const std::uint8_t marker = bytes[at + 1];
    const bool is_other_table = marker == 0xC4 || marker == 0xC8 || marker == 0xCC;
    if (marker >= 0xC0 && marker <= 0xCF && !is_other_table)
      return Size{big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)};
    const bool is_fill_byte = marker == 0xFF;
    at += is_fill_byte ? 1 : 2 + static_cast<std::size_t>(big_endian(bytes, at + 2, 2));
  }
  return std::nullopt;
}

// The size in the header. It is checked first, because a decoder allocates that much before it notices missing data.
std::optional<Size> announced_size(Bytes bytes) {
  if (starts_with(bytes, {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'}) && bytes.size() >= 24)
    return Size{big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)};
  if (starts_with(bytes, {0xFF, 0xD8})) return jpeg_size(bytes);
  const bool is_whole_bmp = starts_with(bytes, {'B', 'M'}) && bytes.size() >= 26 &&
                            little_endian_i32(bytes, 2) <= static_cast<std::int64_t>(bytes.size());
  if (is_whole_bmp) return Size{little_endian_i32(bytes, 18), std::abs(little_endian_i32(bytes, 22))};
  return std::nullopt;
}

bool is_acceptable(const std::optional<Size>& size) {
  return size && size->width > 0 && size->height > 0 && size->width <= kMaxPixels / size->height;
}

cv::Mat decode(Bytes bytes) {
  try {
    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data()));
    return cv::imdecode(raw, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    return {};
  }
}

// Converts to 8 bits and the channels R, G, B, A. Empty when the format has no such conversion.
cv::Mat to_rgba8(cv::Mat image) {
  if (image.depth() == CV_16U) image.convertTo(image, CV_8U, 1.0 / 257);
  if (image.depth() != CV_8U) return {};
  cv::Mat rgba;
  switch (image.channels()) {
    case 1: cv::cvtColor(image, rgba, cv::COLOR_GRAY2RGBA); break;
    case 3: cv::cvtColor(image, rgba, cv::COLOR_BGR2RGBA); break;
    case 4: cv::cvtColor(image, rgba, cv::COLOR_BGRA2RGBA); break;
    default: break;
  }
  return rgba;
}

void shrink(cv::Mat& image, int max_px) {
  const double scale = static_cast<double>(max_px) / std::max(image.cols, image.rows);
  if (scale >= 1) return;
  const auto scaled = [&](int length) { return std::max(1, static_cast<int>(std::lround(length * scale))); };
  cv::resize(image, image, {scaled(image.cols), scaled(image.rows)}, 0, 0, cv::INTER_AREA);
}

}  // namespace

std::shared_ptr<const TextureImage> decode_texture(std::span<const std::uint8_t> bytes, int max_px) {
  if (!is_acceptable(announced_size(bytes))) return nullptr;
  const cv::Mat decoded = decode(bytes);
  if (decoded.empty()) return nullptr;
  cv::Mat rgba = to_rgba8(decoded);
  if (rgba.empty()) return nullptr;
  shrink(rgba, std::max(1, max_px));
  auto texture = std::make_shared<TextureImage>(rgba.cols, rgba.rows);
  static_assert(sizeof(Rgba8) == 4);
  std::memcpy(texture->pixels.data(), rgba.data, texture->pixels.size() * sizeof(Rgba8));
  return texture;
}

bool has_holes(const TextureImage& texture) {
  return std::any_of(texture.pixels.begin(), texture.pixels.end(), [](const Rgba8& texel) { return texel.a < 128; });
}

}  // namespace lapis::simulator
