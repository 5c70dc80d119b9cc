#pragma once

#include <vector>

namespace lapis::segmenter {

/// Numbers in the order of their indices, the last one fastest.
struct Tensor {
  std::vector<int> shape;
  std::vector<float> values;
};

}  // namespace lapis::segmenter
