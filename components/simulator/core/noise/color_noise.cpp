#include "simulator/core/noise/color_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulator/core/noise/motion_blur.hpp"
#include "simulator/core/noise/normal_table.hpp"
#include "simulator/core/noise/random.hpp"

namespace lapis::simulator {
namespace {

using geometry::ColorImage;
using geometry::Rgb8;

constexpr double kUnit = 256.0;  // fixed point: brightness in 1/256 of a grey level
constexpr double kMiddleGrey = 127.5;

/// Brightness of every grey level after contrast, with half a level added for rounding.
std::array<std::int32_t, 256> response(double contrast) {
  std::array<std::int32_t, 256> table;
  for (int level = 0; level < 256; ++level) {
    const double value = kMiddleGrey + contrast * (level - kMiddleGrey);
    table[static_cast<std::size_t>(level)] = static_cast<std::int32_t>(std::lround(kUnit * value + kUnit / 2));
  }
  return table;
}

std::array<std::int16_t, NormalTable::kSize> noise_levels(double sigma) {
  std::array<std::int16_t, NormalTable::kSize> levels;
  const auto& normal = NormalTable::get().values();
  std::transform(normal.begin(), normal.end(), levels.begin(),
                 [sigma](float x) { return static_cast<std::int16_t>(std::lround(kUnit * sigma * x)); });
  return levels;
}

}  // namespace

ColorImage ColorNoise::apply(const ColorImage& ideal, std::uint64_t tick, const Eigen::Vector2d& flow_px) const {
  ColorImage image = motion_blurred(ideal, config_.shutter * flow_px);
  const auto base = response(config_.contrast);
  const auto noise = noise_levels(config_.sigma);
  const Random random(seed_, RandomStream::kColor, tick);
  const auto noisy = [&](std::uint8_t level, std::uint64_t bits) {
    const std::int32_t value = (base[level] + noise[bits % NormalTable::kSize]) >> 8;
    return static_cast<std::uint8_t>(std::clamp(value, 0, 255));
  };
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::uint64_t bits = random.bits(i);
    const Rgb8 in = image.pixels[i];
    image.pixels[i] = {noisy(in.r, bits), noisy(in.g, bits >> NormalTable::kBits),
                       noisy(in.b, bits >> (2 * NormalTable::kBits))};
  }
  return image;
}

}  // namespace lapis::simulator
