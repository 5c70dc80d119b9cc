#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/geometry/image.hpp"

namespace lapis::test {

/// A network whose classes are colours: the logit of a class is 2 p.x - p.p, times `gain`, for its colour p and the
/// pixel's colour x, both from 0 to 1 as red, green, blue. So the nearest colour is the most probable.
struct ColorNetwork {
  std::vector<geometry::Rgb8> colors;
  int width = 32;  ///< of input and output [px]
  int height = 24;
  int opset = 13;
  float gain = 20.0F;
  std::string ending = {};  ///< "", "Softmax", "ArgMax", or any other operator at the end
  bool is_nhwc = false;     ///< input and output with the channel last
  bool has_detour = false;  ///< an encoder and a decoder, whose output is added with the factor 0
  bool has_second_output = false;
  int first_label = 1;  ///< of class 0 in the model's files; the others follow
};

/// Content of an ONNX file; the input is "image", the output "scores" (and "others").
std::string onnx_file(const ColorNetwork& network);

/// Writes network.onnx, model.yaml and colors.yaml: class i of the network is "color i".
/// @return the model file
std::filesystem::path write_color_model(const std::filesystem::path& folder, const ColorNetwork& network);

}  // namespace lapis::test
