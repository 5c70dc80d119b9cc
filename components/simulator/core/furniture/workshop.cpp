#include "simulator/core/furniture/workshop.hpp"

#include <array>

namespace lapis::simulator {

geometry::Rgb8 Workshop::to_rgb(const Paint& paint) {
  const auto byte = [](float value) { return static_cast<std::uint8_t>(value * 255.0F); };
  return {byte(paint.x()), byte(paint.y()), byte(paint.z())};
}

std::uint32_t Workshop::wood() {
  constexpr std::array<geometry::Rgb8, 6> kTones{
      {{222, 190, 148}, {196, 152, 104}, {158, 112, 72}, {120, 82, 54}, {92, 62, 46}, {232, 226, 214}}};
  return textured("wood", kTones[static_cast<std::size_t>(dice.whole(0, 5))]);
}

std::uint32_t Workshop::fabric() { return textured("fabric", to_rgb(dice.color(0.1, 0.65))); }

std::uint32_t Workshop::painting(double aspect) {
  const auto motif = static_cast<std::uint64_t>(dice(0.0, 0x1p40));
  return shapes.material("painting", {255, 255, 255},
                         std::make_shared<const TextureImage>(make_picture(motif, aspect)));
}

void Workshop::legs(float thickness, float height, float inset, std::uint32_t material) {
  for (const float x : {-0.5F * w + inset, 0.5F * w - inset - thickness}) {
    for (const float y : {-0.5F * d + inset, 0.5F * d - inset - thickness})
      box(x, x + thickness, y, y + thickness, 0.0F, height, material);
  }
}

}  // namespace lapis::simulator
