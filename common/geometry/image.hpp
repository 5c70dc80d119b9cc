#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lapis::geometry {

/// Row-major image that owns its pixels; no padding between rows.
template <class Pixel>
struct Image {
  int width = 0;
  int height = 0;
  std::vector<Pixel> pixels;

  Image() = default;
  Image(int width_, int height_, Pixel fill = {})
      : width(width_), height(height_),
        pixels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), fill) {}

  bool empty() const { return pixels.empty(); }
  Pixel& operator()(int column, int row) { return pixels[index(column, row)]; }
  const Pixel& operator()(int column, int row) const { return pixels[index(column, row)]; }

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
  }
};

struct Rgb8 {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb8&) const = default;
};

using ColorImage = Image<Rgb8>;
using GrayImage = Image<std::uint8_t>;
/// z-depth in metres; 0 = no measurement. Never NaN, negative or infinite.
using DepthImage = Image<float>;
/// Class ids; 0 = unlabelled.
using LabelImage = Image<std::uint16_t>;
/// Confidence of a label: 0 to 255 = certain.
using ConfidenceImage = Image<std::uint8_t>;

}  // namespace lapis::geometry
