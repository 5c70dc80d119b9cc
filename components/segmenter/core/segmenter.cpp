#include "segmenter/core/segmenter.hpp"

#include <stdexcept>
#include <string>

#include "segmenter/core/input_tensor.hpp"

namespace lapis::segmenter {
namespace {

/// Shape of what the network gives for a black image.
OutputShape tried_out(Network& network, const Model& model) {
  const geometry::ColorImage black(model.input.width, model.input.height);
  const Tensor output = network.run(to_input(black, model.input));
  try {
    const OutputShape shape = output_shape(output.shape, model.output);
    const std::size_t classes =
        model.output.values == Values::kLabels ? model.classes.size() : static_cast<std::size_t>(shape.classes);
    if (model.classes.size() > classes) {
      throw std::runtime_error("the network has " + std::to_string(classes) + " classes, from 0 on; classes names " +
                               std::to_string(model.classes.size() - 1));
    }
    return shape;
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(model.network.string() + ": " + error.what());
  }
}

}  // namespace

Segmenter::Segmenter(const Model& model)
    : model_(model), network_(model.network, model.output.name), output_(tried_out(network_, model)) {}

Segmentation Segmenter::segment(const geometry::ColorImage& image) {
  const Tensor input = to_input(image, model_.input);
  const Tensor output = network_.run(input);
  Segmentation small = decide(output, model_.output, model_.classes);
  Segmentation result{resized(small.labels, image.width, image.height), {}, small.unusable};
  if (!small.confidence.empty()) result.confidence = resized(small.confidence, image.width, image.height);
  return result;
}

}  // namespace lapis::segmenter
