#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/noise/random.hpp"
#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// sRGB-encoded colour, 0 to 1 (it may leave this range while the picture is being painted).
using Paint = Eigen::Vector3f;

/// Hue (which wraps), saturation and value, each from 0 to 1.
struct Hsv {
  double hue, saturation, value;
};
Paint hsv(const Hsv& color);

/// Smooth noise of zero mean, about -1 to 1, that repeats after `cells` lattice cells in both directions.
class TiledNoise {
 public:
  TiledNoise(const Random& random, int cells);
  /// @param u, v 0 to 1 over one period; other values wrap
  float at(float u, float v) const;

 private:
  int cells_;
  std::vector<float> values_;
};

struct PaintedRectangle {
  double x0, y0, x1, y1;
  Paint paint;
};
struct PaintedEllipse {
  double x, y;
  double radius_x, radius_y;  ///< in units of width and height
  Paint paint;
};
struct PaintedLine {
  double x0, y0, x1, y1;
  double thickness;  ///< in units of the height
  Paint paint;
};
struct PaintedTriangle {
  Eigen::Vector2d a, b, c;
  Paint paint;
};
/// A band whose colour changes from top to bottom.
struct PaintedGradient {
  double y0, y1;
  Paint top, bottom;
};

/// An image that is painted in the unit square: (0, 0) is its upper left corner, x points right, y down.
class Canvas {
 public:
  Canvas(int width_px, int height_px, const Paint& fill);

  int width() const { return width_; }
  int height() const { return height_; }
  Paint& operator()(int column, int row) { return pixels_[index(column, row)]; }
  const Paint& operator()(int column, int row) const { return pixels_[index(column, row)]; }
  /// Middle of a pixel in the unit square.
  Eigen::Vector2f position(int column, int row) const;

  void rectangle(const PaintedRectangle& shape);
  void ellipse(const PaintedEllipse& shape);
  void line(const PaintedLine& shape);
  void triangle(const PaintedTriangle& shape);
  void gradient(const PaintedGradient& shape);

  /// 8-bit image; differences from the mean colour are multiplied by `contrast`.
  TextureImage image(double contrast) const;

 private:
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(column);
  }
  /// Calls function(column, row) for the pixels whose middle is in the box.
  template <class Function>
  void for_box(double x0, double y0, double x1, double y1, const Function& function);

  int width_, height_;
  std::vector<Paint> pixels_;
};

}  // namespace lapis::simulator
