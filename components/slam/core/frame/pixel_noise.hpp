#pragma once

#include <cstddef>
#include <cstdint>

namespace lapis::slam {

/// Rows of grey values, `stride` bytes apart.
struct GrayView {
  const std::uint8_t* pixels = nullptr;
  int width = 0, height = 0;
  std::size_t stride = 0;
};

/// Standard deviation [grey levels] of the noise of a pixel, at least that of rounding. From the median response to a
/// mask that sees neither brightness nor its gradients [Immerkaer 1996]: half of the pixels may lie on edges or on
/// texture. Black and white pixels do not count, because noise is cut off there.
double pixel_noise(const GrayView& image);

}  // namespace lapis::slam
