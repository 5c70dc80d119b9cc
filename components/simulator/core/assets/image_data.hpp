#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// Greatest number of texels of all textures of a model together (4 GiB).
inline constexpr std::size_t kMaxTexels = std::size_t{1} << 30U;

/// Decodes PNG, JPEG or BMP with 8 or 16 bits per channel. An orientation in its EXIF data is ignored. The image is
/// shrunk to at most `max_px` on the longer side (by averaging). Row 0 is the upper edge of the picture. Null when it
/// is no such image or has more than 8192 x 8192 pixels.
std::shared_ptr<const TextureImage> decode_texture(std::span<const std::uint8_t> bytes, int max_px);

/// True when some texel has alpha below 128.
bool has_holes(const TextureImage& texture);

}  // namespace lapis::simulator
