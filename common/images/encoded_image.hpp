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

/// Size [px] in the header of a JPEG (ISO/IEC 10918-1, B.2.2) or PNG (ISO/IEC 15948, 11.2.2), at most 65535 by 65535;
/// nothing for other bytes. Compare it with the expected size before memory of that size is allocated.
std::optional<ImageSize> encoded_size(std::span<const std::uint8_t> bytes);

/// True for a JPEG without an end marker: libjpeg fills the missing part with grey and reports success.
bool is_truncated_jpeg(std::span<const std::uint8_t> bytes);

/// Grey values of a JPEG or PNG, with the pixels in the stored order (orientation tags are ignored); nothing when the
/// image is damaged.
std::optional<geometry::GrayImage> decode_gray(std::span<const std::uint8_t> bytes);
/// The same for colours.
std::optional<geometry::ColorImage> decode_color(std::span<const std::uint8_t> bytes);

/// Values of a grey PNG with 16 bits per pixel; nothing when the image is damaged or of another kind.
std::optional<geometry::Image<std::uint16_t>> decode_wide(std::span<const std::uint8_t> bytes);

}  // namespace lapis::images
