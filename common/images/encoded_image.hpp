#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "common/geometry/image.hpp"

namespace lapis::images {

struct ImageSize {
  int width = 0;
  int height = 0;
  bool operator==(const ImageSize&) const = default;
};

/// Size that the header of a JPEG (ISO/IEC 10918-1, B.2.2) or PNG (ISO/IEC 15948, 11.2.2) promises, at most 65535 each
/// way; nothing for other bytes. To be compared with what is expected before anything of that size is allocated.
std::optional<ImageSize> encoded_size(std::span<const std::uint8_t> bytes);

/// True for a JPEG without an end: libjpeg fills the rest with grey and calls it a success.
bool is_truncated_jpeg(std::span<const std::uint8_t> bytes);

/// Grey values of a JPEG or PNG, pixels as they are stored (orientation tags are left alone); nothing when it is
/// damaged.
std::optional<geometry::GrayImage> decode_gray(std::span<const std::uint8_t> bytes);

}  // namespace lapis::images
