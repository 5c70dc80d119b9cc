#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/image.hpp"
#include "segmenter/core/model.hpp"
#include "segmenter/core/tensor.hpp"

namespace lapis::segmenter {

/// The labels of an image.
struct Segmentation {
  geometry::LabelImage labels;
  /// Probability that the label is right, 255 = certain; empty where the network gives labels alone.
  geometry::ConfidenceImage confidence;
  std::size_t unusable = 0;  ///< pixels of the network's output that are not numbers; they are unlabelled
};

/// Size of a network's output, and where its values lie: that of class c at pixel p (row by row) has the index
/// c * class_stride + p * pixel_stride.
struct OutputShape {
  int classes = 0;  ///< 0: the network gives labels
  int width = 0;    ///< [px]
  int height = 0;
  std::size_t class_stride = 0;
  std::size_t pixel_stride = 1;
};

/// @throws std::runtime_error naming shape and key when the output cannot be one of that format
OutputShape output_shape(const std::vector<int>& shape, const OutputFormat& format);

/// The label of the most probable class of each pixel, of equal ones the first. The confidence is the probability of
/// all classes with that label together.
/// @param scores output of a network
Segmentation decide(const Tensor& scores, const OutputFormat& format, const ClassTable& classes);

/// The image at another size; a pixel has the value of the one in which its centre lies.
template <class Pixel>
geometry::Image<Pixel> resized(const geometry::Image<Pixel>& image, int width, int height) {
  geometry::Image<Pixel> result(width, height);
  for (int row = 0; row < height; ++row) {
    const int from_row = (2 * row + 1) * image.height / (2 * height);
    for (int column = 0; column < width; ++column) {
      result(column, row) = image((2 * column + 1) * image.width / (2 * width), from_row);
    }
  }
  return result;
}

}  // namespace lapis::segmenter
