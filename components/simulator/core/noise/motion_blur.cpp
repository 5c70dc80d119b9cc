#include "simulator/core/noise/motion_blur.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace lapis::simulator {
namespace {

using geometry::ColorImage;
using geometry::Rgb8;

constexpr int kMaxHalf_px = 32;
constexpr int kPadding = kMaxHalf_px + 1;  // columns by which a row is extended on either side

// The sums of the three channels are in one number; the sums of a row of 8000 pixels fit.
constexpr unsigned kChannelBits = 21;
constexpr std::uint64_t kChannelMask = (std::uint64_t{1} << kChannelBits) - 1;

std::uint64_t packed(const Rgb8& pixel) {
  return pixel.r | std::uint64_t{pixel.g} << kChannelBits | std::uint64_t{pixel.b} << (2 * kChannelBits);
}

/// The part of the line that lies in one row: columns `first` to `last`, relative to the centre.
struct Run {
  int row, first, last;
};

/// The pixels nearest to the points of a line at -half, ..., half steps of one pixel along its longer axis.
std::vector<Run> runs_of(const Eigen::Vector2d& line_px, int half) {
  const Eigen::Vector2d step = line_px / line_px.lpNorm<Eigen::Infinity>();
  std::vector<Run> runs;
  for (int i = -half; i <= half; ++i) {
    const int column = static_cast<int>(std::lround(i * step.x())), row = static_cast<int>(std::lround(i * step.y()));
    if (runs.empty() || runs.back().row != row) {
      runs.push_back({row, column, column});
    } else {
      runs.back().first = std::min(runs.back().first, column);
      runs.back().last = std::max(runs.back().last, column);
    }
  }
  return runs;
}

/// Sums over each row from the left: entry c is the sum of the columns before c - kPadding.
class RowSums {
 public:
  explicit RowSums(const ColorImage& image)
      : stride_(static_cast<std::size_t>(image.width + 2 * kPadding + 1)),
        sums_(stride_ * static_cast<std::size_t>(image.height)) {
    for (int row = 0; row < image.height; ++row) {
      std::uint64_t* out = &sums_[static_cast<std::size_t>(row) * stride_];
      std::uint64_t sum = 0;
      *out++ = sum;
      for (int i = 0; i < kPadding; ++i) *out++ = sum += packed(image(0, row));
      for (int i = 0; i < image.width; ++i) *out++ = sum += packed(image(i, row));
      for (int i = 0; i < kPadding; ++i) *out++ = sum += packed(image(image.width - 1, row));
    }
  }
  /// Pointer p such that p[c] is the sum of the columns before c, for c from -kPadding to width + kPadding.
  const std::uint64_t* before(int row) const { return &sums_[static_cast<std::size_t>(row) * stride_ + kPadding]; }

 private:
  std::size_t stride_;
  std::vector<std::uint64_t> sums_;
};

/// Divides the packed sums of `count` pixels by `count`; exact for counts up to 65.
class Mean {
 public:
  explicit Mean(int count)
      : half_(static_cast<std::uint64_t>(count) / 2),
        reciprocal_(((std::uint64_t{1} << kShift) + static_cast<std::uint64_t>(count) - 1) /
                    static_cast<std::uint64_t>(count)) {}
  Rgb8 operator()(std::uint64_t sums) const {
    return {channel(sums), channel(sums >> kChannelBits), channel(sums >> (2 * kChannelBits))};
  }

 private:
  static constexpr unsigned kShift = 24;
  std::uint8_t channel(std::uint64_t sums) const {
    return static_cast<std::uint8_t>((((sums & kChannelMask) + half_) * reciprocal_) >> kShift);
  }
  std::uint64_t half_, reciprocal_;
};

}  // namespace

ColorImage motion_blurred(const ColorImage& image, const Eigen::Vector2d& line_px) {
  if (image.empty() || !line_px.allFinite()) return image;
  const double length_px = std::min(line_px.lpNorm<Eigen::Infinity>(), 2.0 * kMaxHalf_px);
  const int half = static_cast<int>(std::lround(length_px / 2));
  if (half == 0) return image;
  const std::vector<Run> runs = runs_of(line_px, half);
  const RowSums row_sums(image);
  const Mean mean(2 * half + 1);
  ColorImage result(image.width, image.height);
  std::vector<std::uint64_t> sums(static_cast<std::size_t>(image.width));
  for (int row = 0; row < image.height; ++row) {
    std::fill(sums.begin(), sums.end(), std::uint64_t{0});
    for (const Run& run : runs) {
      const std::uint64_t* before = row_sums.before(std::clamp(row + run.row, 0, image.height - 1));
      for (int c = 0; c < image.width; ++c)
        sums[static_cast<std::size_t>(c)] += before[c + run.last + 1] - before[c + run.first];
    }
    std::transform(sums.begin(), sums.end(), &result(0, row), mean);
  }
  return result;
}

}  // namespace lapis::simulator
