#pragma once

#include <Eigen/Core>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

/// Mean of the image along a straight line that is centred at every pixel; pixels beyond the border are like those at
/// it. The time it takes hardly depends on the length when the line is nearly horizontal.
/// @param line_px from one end to the other. With n half of the larger of |x| and |y|, rounded, 2 n + 1 pixels are
///                averaged, so that nothing is shifted; n = 0 or a line that is not finite changes nothing; n is at
///                most 32.
geometry::ColorImage motion_blurred(const geometry::ColorImage& image, const Eigen::Vector2d& line_px);

}  // namespace lapis::simulator
