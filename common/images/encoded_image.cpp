#include "common/images/encoded_image.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace lapis::images {
namespace {

using Bytes = std::span<const std::uint8_t>;

constexpr std::array<std::uint8_t, 2> kJpegStart{0xFF, 0xD8};
constexpr std::array<std::uint8_t, 16> kPngStart{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n',
                                                 0,    0,   0,   13,  'I',  'H',  'D',  'R'};
constexpr std::uint32_t kLargestSide = 65535;

template <std::size_t kSize>
bool begins_with(Bytes bytes, const std::array<std::uint8_t, kSize>& start) {
  return bytes.size() >= kSize && std::equal(start.begin(), start.end(), bytes.begin());
}

/// Big-endian number of `count` bytes from byte `at`, which must exist.
std::uint32_t big_endian(Bytes bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (const std::uint8_t byte : bytes.subspan(at, count)) value = value << 8 | byte;
  return value;
}

std::optional<ImageSize> checked_size(std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || width > kLargestSide || height > kLargestSide) return std::nullopt;
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

/// The image without gaps between its rows; empty when it is damaged.
cv::Mat decode(Bytes bytes, int flags) {
  if (!encoded_size(bytes) || is_truncated_jpeg(bytes) || bytes.size() > std::numeric_limits<int>::max()) return {};
  try {
    // The const_cast is safe because the decoder does not write to its input.
    const cv::Mat coded(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data()));
    const cv::Mat image = cv::imdecode(coded, flags | cv::IMREAD_IGNORE_ORIENTATION);
    return image.isContinuous() ? image : cv::Mat();
  } catch (const cv::Exception&) {
    return {};
  }
}

// Start of frame: 0xC0 to 0xCF except the markers of Huffman tables, JPEG extensions and arithmetic conditioning.
bool is_frame_header(std::uint8_t marker) {
  return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

std::optional<ImageSize> jpeg_size(Bytes bytes) {
  constexpr std::size_t kToEndOfSize = 9;  // marker, length, bits, height, width
  std::size_t at = kJpegStart.size();
  while (at + kToEndOfSize <= bytes.size() && bytes[at] == 0xFF) {
    const std::uint8_t marker = bytes[at + 1];
    if (is_frame_header(marker)) return checked_size(big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2));
    at += marker == 0xFF ? 1 : 2 + big_endian(bytes, at + 2, 2);  // 0xFF: fill byte
  }
  return std::nullopt;
}

/// The decoded image if it has the pixels of an Image<Pixel>; nothing when it is damaged.
template <class Pixel>
std::optional<geometry::Image<Pixel>> decode(Bytes bytes, int flags) {
  const cv::Mat image = decode(bytes, flags);
  if (image.empty() || image.type() != cv::traits::Type<Pixel>::value) return std::nullopt;
  geometry::Image<Pixel> out(image.cols, image.rows);
  std::copy_n(image.ptr<Pixel>(), out.pixels.size(), out.pixels.begin());
  return out;
}

}  // namespace

std::optional<ImageSize> encoded_size(Bytes bytes) {
  if (begins_with(bytes, kJpegStart)) return jpeg_size(bytes);
  if (!begins_with(bytes, kPngStart) || bytes.size() < kPngStart.size() + 8) return std::nullopt;
  return checked_size(big_endian(bytes, kPngStart.size(), 4), big_endian(bytes, kPngStart.size() + 4, 4));
}

bool is_truncated_jpeg(Bytes bytes) {
  if (bytes.size() < 4 || !begins_with(bytes, kJpegStart)) return false;
  constexpr std::size_t kMaxTail = 64;  // some cameras append a few bytes
  const std::size_t stop = bytes.size() > kMaxTail ? bytes.size() - kMaxTail : 2;
  for (std::size_t i = bytes.size() - 1; i > stop; --i) {
    if (bytes[i - 1] == 0xFF && bytes[i] == 0xD9) return false;
  }
  return true;
}

std::optional<geometry::GrayImage> decode_gray(Bytes bytes) {
  return decode<std::uint8_t>(bytes, cv::IMREAD_GRAYSCALE);
}

std::optional<geometry::Image<std::uint16_t>> decode_wide(Bytes bytes) {
  return decode<std::uint16_t>(bytes, cv::IMREAD_UNCHANGED);
}

std::optional<geometry::ColorImage> decode_color(Bytes bytes) {
  const cv::Mat image = decode(bytes, cv::IMREAD_COLOR);
  if (image.empty()) return std::nullopt;
  geometry::ColorImage color(image.cols, image.rows);
  const auto* bgr = image.ptr<cv::Vec3b>();
  for (auto& pixel : color.pixels) {
    pixel = {(*bgr)[2], (*bgr)[1], (*bgr)[0]};
    ++bgr;
  }
  return color;
}

}  // namespace lapis::images
