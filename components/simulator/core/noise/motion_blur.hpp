#pragma once

#include <Eigen/Core>

#include "common/geometry/image.hpp"

namespace lapis::simulator {

/// Mean of the image along a straight line that is centred at every pixel; pixels beyond the border are like those at
/// it. The time that it takes hardly depends on the line's length when it is nearly horizontal.
/// @param line_px vector from one end of the line to the other. 2 n + 1 pixels are averaged, so that nothing is
///                shifted; n is half of the larger of |x| and |y|, rounded, and at most 32. n = 0, or a line that is
///                not finite, changes nothing.
geometry::ColorImage motion_blurred(const geometry::ColorImage& image, const Eigen::Vector2d& line_px);

}  // namespace lapis::simulator
