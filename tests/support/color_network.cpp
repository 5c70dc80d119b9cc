#include "tests/support/color_network.hpp"

#include <fstream>

#include "tests/support/onnx_model.hpp"

namespace lapis::test {
namespace {

using Shape = OnnxModel::Shape;

constexpr float kLargest = 255.0F;

/// Weights and biases of the classes' logits.
void add_logits(OnnxModel& model, const ColorNetwork& network, const std::string& from, const std::string& to) {
  std::vector<float> weights, biases;
  for (const auto& color : network.colors) {
    float norm = 0.0F;
    for (const auto value : {color.r, color.g, color.b}) {
      const float p = static_cast<float>(value) / kLargest;
      weights.push_back(2.0F * network.gain * p);
      norm += p * p;
    }
    biases.push_back(-network.gain * norm);
  }
  const auto classes = static_cast<std::int64_t>(network.colors.size());
  model.weights("weights", {classes, 3, 1, 1}, weights);
  model.weights("biases", {classes}, biases);
  model.node("Conv", {from, "weights", "biases"}, to, {{"kernel_shape", Shape{1, 1}}});
}

/// 3 x 3 convolution, pooling and back to the old size; adds nothing, but has to be right to do so.
void add_detour(OnnxModel& model, const ColorNetwork& network, const std::string& from, const std::string& to) {
  const auto classes = static_cast<std::int64_t>(network.colors.size());
  model.weights("blur", {4, 3, 3, 3}, std::vector<float>(4 * 3 * 9, 1.0F / 27.0F));
  model.node("Conv", {"rgb", "blur"}, "blurred", {{"kernel_shape", Shape{3, 3}}, {"pads", Shape{1, 1, 1, 1}}});
  model.node("Relu", {"blurred"}, "positive");
  model.node("MaxPool", {"positive"}, "pooled", {{"kernel_shape", Shape{2, 2}}, {"strides", Shape{2, 2}}});
  model.weights("no_region", {0}, {});
  model.weights("scales", {4}, {1.0F, 1.0F, 2.0F, 2.0F});
  model.node("Resize", {"pooled", "no_region", "scales"}, "large",
             {{"mode", std::string("nearest")},
              {"coordinate_transformation_mode", std::string("asymmetric")},
              {"nearest_mode", std::string("floor")}});
  model.weights("nothing", {classes, 4, 1, 1}, std::vector<float>(4 * network.colors.size(), 0.0F));
  model.node("Conv", {"large", "nothing"}, "zero", {{"kernel_shape", Shape{1, 1}}});
  model.node("Add", {from, "zero"}, to);
}

}  // namespace

std::string onnx_file(const ColorNetwork& network) {
  const auto classes = static_cast<std::int64_t>(network.colors.size());
  const std::int64_t width = network.width, height = network.height;
  OnnxModel model(network.opset);
  model.input("image", network.is_nhwc ? Shape{1, height, width, 3} : Shape{1, 3, height, width});
  const std::string rgb = network.is_nhwc || network.has_detour ? "rgb" : "image";
  if (network.is_nhwc) model.node("Transpose", {"image"}, "rgb", {{"perm", Shape{0, 3, 1, 2}}});
  if (!network.is_nhwc && network.has_detour) model.node("Identity", {"image"}, "rgb");
  std::string last = "logits";
  if (network.has_detour) {
    add_logits(model, network, rgb, "direct");
    add_detour(model, network, "direct", "logits");
  } else {
    add_logits(model, network, rgb, "logits");
  }
  const std::int64_t axis = 1;
  if (network.ending == "ArgMax") {
    model.node("ArgMax", {last}, "scores", {{"axis", axis}, {"keepdims", std::int64_t{1}}});
    model.output("scores", {1, 1, height, width}, true);
    return model.bytes();
  }
  if (network.ending == "Softmax") {
    model.node("Softmax", {last}, "chosen", {{"axis", axis}});
    last = "chosen";
  } else if (!network.ending.empty()) {
    model.node(network.ending, {last}, "chosen");
    last = "chosen";
  }
  const std::string final_op = network.is_nhwc ? "Transpose" : "Identity";
  model.node(final_op, {last}, "scores",
             network.is_nhwc ? std::vector<OnnxModel::Attribute>{{"perm", Shape{0, 2, 3, 1}}}
                             : std::vector<OnnxModel::Attribute>{});
  model.output("scores", network.is_nhwc ? Shape{1, height, width, classes} : Shape{1, classes, height, width});
  if (network.has_second_output) {
    model.node("Relu", {"logits"}, "others");
    model.output("others", {1, classes, height, width});
  }
  return model.bytes();
}

std::filesystem::path write_color_model(const std::filesystem::path& folder, const ColorNetwork& network) {
  const std::string bytes = onnx_file(network);
  std::ofstream(folder / "network.onnx", std::ios::binary)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::string labels, classes;
  for (std::size_t i = 0; i < network.colors.size(); ++i) {
    const std::string name = "color " + std::to_string(i);
    labels +=
        "  - {id: " + std::to_string(static_cast<std::size_t>(network.first_label) + i) + ", name: " + name + "}\n";
    classes += "  " + std::to_string(i) + ": " + name + "\n";
  }
  std::ofstream(folder / "colors.yaml") << "labels:\n" << labels;
  const std::string layout = network.is_nhwc ? "NHWC" : "NCHW";
  const std::string values = network.ending == "ArgMax"    ? "labels"
                             : network.ending == "Softmax" ? "probabilities"
                                                           : "logits";
  std::ofstream(folder / "model.yaml") << "network: network.onnx\nlabels: colors.yaml\ninput: {width: " << network.width
                                       << ", height: " << network.height << ", layout: " << layout
                                       << "}\noutput: {values: " << values << ", layout: " << layout
                                       << (network.has_second_output ? ", name: scores" : "") << "}\nclasses:\n"
                                       << classes;
  return folder / "model.yaml";
}

}  // namespace lapis::test
