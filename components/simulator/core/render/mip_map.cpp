#include "simulator/core/render/mip_map.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::simulator {
namespace {

constexpr int kFractionBits = 8;
constexpr int kOne = 1 << kFractionBits;

/// Mixes two channels; weight of `b` in 1/256.
int mix(int a, int b, int weight) { return a * (kOne - weight) + b * weight; }

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

/// Neighbours of a position in 1/256 texel on an axis that repeats, and the weight of the second.
struct Neighbours {
  int first, second, weight;
};

Neighbours neighbours(int position, int size) {
  const int texel = position >> kFractionBits;  // -1 to size - 1: centres are at half texels
  const int first = texel < 0 ? texel + size : texel;
  return {first, first + 1 == size ? 0 : first + 1, position & (kOne - 1)};
}

}  // namespace

MipMap::MipMap(std::shared_ptr<const TextureImage> texture) : finest_(std::move(texture)) {
  while (std::min(level(levels() - 1).width, level(levels() - 1).height) > 1) {
    coarser_.push_back(halved(level(levels() - 1)));
  }
}

geometry::Rgb8 MipMap::sample(int level_index, float x, float y) const {
  const TextureImage& image = level(level_index);
  // The subtraction of the floor keeps huge coordinates in range; rounding may still give exactly 1.
  const float column = std::min(x - std::floor(x), 0.999999F) * static_cast<float>(image.width * kOne);
  const float row = std::min(1.0F - (y - std::floor(y)), 0.999999F) * static_cast<float>(image.height * kOne);
  const Neighbours u = neighbours(static_cast<int>(column) - kOne / 2, image.width);
  const Neighbours v = neighbours(static_cast<int>(row) - kOne / 2, image.height);
  const Rgba8 &a = image(u.first, v.first), &b = image(u.second, v.first), &c = image(u.first, v.second),
              &d = image(u.second, v.second);
  const auto channel = [&](int p, int q, int r, int s) {
    const int sum = mix(mix(p, q, u.weight), mix(r, s, u.weight), v.weight);
    return static_cast<std::uint8_t>((sum + (1 << (2 * kFractionBits - 1))) >> (2 * kFractionBits));
  };
  return {channel(a.r, b.r, c.r, d.r), channel(a.g, b.g, c.g, d.g), channel(a.b, b.b, c.b, d.b)};
}

}  // namespace lapis::simulator
