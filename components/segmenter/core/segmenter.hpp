#pragma once

#include "segmenter/core/decision.hpp"
#include "segmenter/core/network.hpp"

namespace lapis::segmenter {

/// Labels images by a network.
class Segmenter {
 public:
  /// Reads the network, and runs it once on a black image.
  /// @throws std::runtime_error naming file, key and remedy when network and model do not fit
  explicit Segmenter(const Model& model);

  /// Labels and confidence, in the size of the image.
  Segmentation segment(const geometry::ColorImage& image);
  const OutputShape& output() const { return output_; }

 private:
  Model model_;
  Network network_;
  OutputShape output_;
};

}  // namespace lapis::segmenter
