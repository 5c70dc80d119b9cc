#include "slam/core/frame/pixel_noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace lapis::slam {
namespace {

constexpr int kRowStep = 8;  // rows of one sample; a few thousand pixels give the median within 3 %
constexpr int kColumnStep = 2;
constexpr double kMaskNorm = 6.0;              // of the mask (1 -2 1; -2 4 -2; 1 -2 1)
constexpr double kMedianOfNormal = 0.6744898;  // of the absolute value, in sigmas

// Response of the mask is at most 8 * 255.
using Histogram = std::array<int, 8 * 255 + 1>;

int median_of(const Histogram& histogram, int count) {
  int below = 0;
  for (std::size_t value = 0; value < histogram.size(); ++value) {
    below += histogram[value];
    if (2 * below > count) return static_cast<int>(value);
  }
  return 0;
}

}  // namespace

double pixel_noise(const GrayView& image) {
  const double rounding = 1.0 / std::sqrt(12.0);
  Histogram histogram{};
  int count = 0;
  for (int y = 1; y + 1 < image.height; y += kRowStep) {
    const std::uint8_t* row = image.pixels + static_cast<std::size_t>(y) * image.stride;
    const std::uint8_t* above = row - image.stride;
    const std::uint8_t* below = row + image.stride;
    for (int x = 1; x + 1 < image.width; x += kColumnStep) {
      if (row[x] == 0 || row[x] == 255) continue;
      const int response = above[x - 1] + above[x + 1] + below[x - 1] + below[x + 1] + 4 * row[x] -
                           2 * (above[x] + below[x] + row[x - 1] + row[x + 1]);
      ++histogram[static_cast<std::size_t>(std::abs(response))];
      ++count;
    }
  }
  return std::max(rounding, median_of(histogram, count) / (kMedianOfNormal * kMaskNorm));
}

}  // namespace lapis::slam
