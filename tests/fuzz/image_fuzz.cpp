#include "simulator/core/assets/image_data.hpp"

#include <cstddef>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr int kMax_px = 32;
  const auto texture = lapis::simulator::decode_texture({data, size}, kMax_px);
  if (!texture) return 0;
  const bool is_sound =
      texture->width > 0 && texture->height > 0 && texture->width <= kMax_px && texture->height <= kMax_px &&
      texture->pixels.size() == static_cast<std::size_t>(texture->width) * static_cast<std::size_t>(texture->height);
  if (!is_sound) std::abort();
  lapis::simulator::has_holes(*texture);
  return 0;
}
