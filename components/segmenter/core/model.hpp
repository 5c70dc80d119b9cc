#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "segmenter/core/class_table.hpp"

namespace lapis::segmenter {

/// Order of the indices of an image: number of the image, channel, row, column; or channel last.
enum class Layout { kNchw, kNhwc };
enum class Channels { kRgb, kBgr };
enum class Values {
  kLogits,         ///< a number per class, of which softmax makes probabilities
  kProbabilities,  ///< a number per class; their sum is 1
  kLabels          ///< the index of a class
};

/// What a network takes. Channel c of a pixel is (value * scale - mean[c]) / std[c], value from 0 to 255.
struct InputFormat {
  int width = 0;  ///< to which every image is scaled [px]
  int height = 0;
  Layout layout = Layout::kNchw;
  Channels channels = Channels::kRgb;
  double scale = 1.0 / 255.0;
  std::array<double, 3> mean{0.0, 0.0, 0.0};  ///< in the order of `channels`, and so is std
  std::array<double, 3> std{1.0, 1.0, 1.0};
};

/// What a network gives.
struct OutputFormat {
  std::string name;  ///< empty: its only output
  Layout layout = Layout::kNchw;
  Values values = Values::kLogits;
};

/// A network and how it is used.
struct Model {
  std::filesystem::path network;  ///< ONNX file
  InputFormat input;
  OutputFormat output;
  ClassTable classes;
};

}  // namespace lapis::segmenter
