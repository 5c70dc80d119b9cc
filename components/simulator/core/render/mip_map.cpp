#include "simulator/core/render/mip_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace lapis::simulator {
namespace {

constexpr int kFractionBits = 8;
constexpr int kOne = 1 << kFractionBits;

int power_of_two(int size) { return static_cast<int>(std::bit_ceil(static_cast<unsigned int>(size))); }

/// Mixes two channels; weight of `b` in 1/256.
int mix(int a, int b, int weight) { return a * (kOne - weight) + b * weight; }

std::uint8_t average(int a, int b, int c, int d) { return static_cast<std::uint8_t>((a + b + c + d + 2) / 4); }

/// Nearest-neighbour scaling up to powers of two keeps texels as they are.
TextureImage with_sides_of_two(const TextureImage& texture) {
  TextureImage out(power_of_two(texture.width), power_of_two(texture.height));
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      out(x, y) = texture(static_cast<int>(static_cast<std::int64_t>(x) * texture.width / out.width),
                          static_cast<int>(static_cast<std::int64_t>(y) * texture.height / out.height));
    }
  }
  return out;
}

TextureImage halved(const TextureImage& fine) {
  TextureImage out(std::max(fine.width / 2, 1), std::max(fine.height / 2, 1));
  const int dx = fine.width > 1 ? 1 : 0, dy = fine.height > 1 ? 1 : 0;
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      const int fx = x * (1 + dx), fy = y * (1 + dy);
      const Rgba8 &a = fine(fx, fy), &b = fine(fx + dx, fy), &c = fine(fx, fy + dy), &d = fine(fx + dx, fy + dy);
      out(x, y) = {average(a.r, b.r, c.r, d.r), average(a.g, b.g, c.g, d.g), average(a.b, b.b, c.b, d.b),
                   average(a.a, b.a, c.a, d.a)};
    }
  }
  return out;
}

}  // namespace

MipMap::MipMap(const TextureImage& texture) {
  levels_.push_back(with_sides_of_two(texture));
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(halved(levels_.back()));
}

geometry::Rgb8 MipMap::sample(int level, float x, float y) const {
  const TextureImage& image = levels_[static_cast<std::size_t>(level)];
  // Texel centres are at half integers; the subtraction of the floor keeps huge coordinates in range.
  const float column = (x - std::floor(x)) * static_cast<float>(image.width * kOne);
  const float row = (1.0F - (y - std::floor(y))) * static_cast<float>(image.height * kOne);
  const int u = static_cast<int>(column) - kOne / 2, v = static_cast<int>(row) - kOne / 2;
  const int wu = u & (kOne - 1), wv = v & (kOne - 1);
  const int mask_x = image.width - 1, mask_y = image.height - 1;
  const int x0 = (u >> kFractionBits) & mask_x, x1 = (x0 + 1) & mask_x;
  const int y0 = (v >> kFractionBits) & mask_y, y1 = (y0 + 1) & mask_y;
  const Rgba8 &a = image(x0, y0), &b = image(x1, y0), &c = image(x0, y1), &d = image(x1, y1);
  const auto channel = [&](int p, int q, int r, int s) {
    return static_cast<std::uint8_t>((mix(mix(p, q, wu), mix(r, s, wu), wv) + (1 << 15)) >> (2 * kFractionBits));
  };
  return {channel(a.r, b.r, c.r, d.r), channel(a.g, b.g, c.g, d.g), channel(a.b, b.b, c.b, d.b)};
}

std::size_t MipMap::bytes() const {
  std::size_t sum = 0;
  for (const auto& image : levels_) sum += image.pixels.size() * sizeof(Rgba8);
  return sum;
}

}  // namespace lapis::simulator
