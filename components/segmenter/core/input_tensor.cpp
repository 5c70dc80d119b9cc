#include "segmenter/core/input_tensor.hpp"

#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace lapis::segmenter {
namespace {

geometry::ColorImage scaled(const geometry::ColorImage& image, int width, int height) {
  if (image.width == width && image.height == height) return image;
  geometry::ColorImage result(width, height);
  // The const_cast is safe because a source is not written to.
  const cv::Mat from(image.height, image.width, CV_8UC3, const_cast<geometry::Rgb8*>(image.pixels.data()));
  cv::Mat to(height, width, CV_8UC3, result.pixels.data());
  const bool shrinks = width <= image.width && height <= image.height;
  cv::resize(from, to, to.size(), 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return result;
}

/// Channel `c` of the network's three.
std::uint8_t channel(const geometry::Rgb8& pixel, std::size_t c, Channels order) {
  if (c == 1) return pixel.g;
  return (c == 0) == (order == Channels::kRgb) ? pixel.r : pixel.b;
}

}  // namespace

Tensor to_input(const geometry::ColorImage& image, const InputFormat& format) {
  const geometry::ColorImage input = scaled(image, format.width, format.height);
  const std::size_t pixels = input.pixels.size();
  const bool is_planar = format.layout == Layout::kNchw;
  Tensor tensor{{1, 3, format.height, format.width}, std::vector<float>(3 * pixels)};
  if (!is_planar) tensor.shape = {1, format.height, format.width, 3};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto factor = static_cast<float>(format.scale / format.std[c]);
    const auto offset = static_cast<float>(-format.mean[c] / format.std[c]);
    float* value = tensor.values.data() + (is_planar ? c * pixels : c);
    for (const auto& pixel : input.pixels) {
      *value = factor * static_cast<float>(channel(pixel, c, format.channels)) + offset;
      value += is_planar ? 1 : 3;
    }
  }
  return tensor;
}

}  // namespace lapis::segmenter
