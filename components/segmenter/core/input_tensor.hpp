#pragma once

#include "common/geometry/image.hpp"
#include "segmenter/core/model.hpp"
#include "segmenter/core/tensor.hpp"

namespace lapis::segmenter {

/// The image as a network takes it, 1 x 3 x height x width or 1 x height x width x 3. It is scaled to the size of the
/// input, whatever its aspect ratio: averaged over the area of a pixel where it becomes smaller, else interpolated.
Tensor to_input(const geometry::ColorImage& image, const InputFormat& format);

}  // namespace lapis::segmenter
