#include "simulator/core/render/mip_map.hpp"

#include <algorithm>

namespace lapis::simulator {
namespace {

std::uint8_t average(int a, int b, int c, int d) { return static_cast<std::uint8_t>((a + b + c + d + 2) / 4); }

TextureImage halved(const TextureImage& fine) {
  TextureImage out(fine.width / 2, fine.height / 2);
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const Rgba8 &a = fine(2 * x, 2 * y), &b = fine(2 * x + 1, 2 * y), &c = fine(2 * x, 2 * y + 1),
                  &d = fine(2 * x + 1, 2 * y + 1);
      out(x, y) = {average(a.r, b.r, c.r, d.r), average(a.g, b.g, c.g, d.g), average(a.b, b.b, c.b, d.b),
                   average(a.a, b.a, c.a, d.a)};
    }
  }
  return out;
}

}  // namespace

MipMap::MipMap(std::shared_ptr<const TextureImage> texture) : finest_(std::move(texture)) {
  while (std::min(level(levels() - 1).width, level(levels() - 1).height) > 1) {
    coarser_.push_back(halved(level(levels() - 1)));
  }
}

}  // namespace lapis::simulator
