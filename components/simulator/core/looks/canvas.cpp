#include "simulator/core/looks/canvas.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::simulator {
namespace {

float smooth(float t) { return t * t * (3.0F - 2.0F * t); }

int wrapped(int value, int period) { return ((value % period) + period) % period; }

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(std::lround(value * 255.0F), 0L, 255L));
}

}  // namespace

Paint hsv(const Hsv& color) {
  const double sector = (color.hue - std::floor(color.hue)) * 6.0;
  const auto channel = [&](double n) {
    const double k = std::fmod(n + sector, 6.0);
    return static_cast<float>(color.value * (1.0 - color.saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0)));
  };
  return {channel(5.0), channel(3.0), channel(1.0)};
}

TiledNoise::TiledNoise(const Random& random, int cells) : cells_(cells) {
  const auto count = static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells);
  values_.reserve(count);
  for (std::size_t i = 0; i < count; ++i) values_.push_back(static_cast<float>(random.uniform(i, -1.0, 1.0)));
}

float TiledNoise::at(float u, float v) const {
  const float x = u * static_cast<float>(cells_), y = v * static_cast<float>(cells_);
  const float floor_x = std::floor(x), floor_y = std::floor(y);
  const int x0 = wrapped(static_cast<int>(floor_x), cells_), y0 = wrapped(static_cast<int>(floor_y), cells_);
  const int x1 = x0 + 1 == cells_ ? 0 : x0 + 1, y1 = y0 + 1 == cells_ ? 0 : y0 + 1;
  const auto value = [&](int column, int row) {
    return values_[static_cast<std::size_t>(row) * static_cast<std::size_t>(cells_) + static_cast<std::size_t>(column)];
  };
  const float s = smooth(x - floor_x), t = smooth(y - floor_y);
  const float upper = value(x0, y0) + s * (value(x1, y0) - value(x0, y0));
  const float lower = value(x0, y1) + s * (value(x1, y1) - value(x0, y1));
  return upper + t * (lower - upper);
}

Canvas::Canvas(int width_px, int height_px, const Paint& fill)
    : width_(width_px), height_(height_px),
      pixels_(static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px), fill) {}

Eigen::Vector2f Canvas::position(int column, int row) const {
  return {(static_cast<float>(column) + 0.5F) / static_cast<float>(width_),
          (static_cast<float>(row) + 0.5F) / static_cast<float>(height_)};
}

template <class Function>
void Canvas::for_box(double x0, double y0, double x1, double y1, const Function& function) {
  const auto first = [](double x, int size) { return std::max(0, static_cast<int>(std::ceil(x * size - 0.5))); };
  const auto end = [](double x, int size) { return std::min(size, static_cast<int>(std::ceil(x * size - 0.5))); };
  for (int row = first(y0, height_); row < end(y1, height_); ++row) {
    for (int column = first(x0, width_); column < end(x1, width_); ++column) function(column, row);
  }
}

void Canvas::rectangle(const PaintedRectangle& shape) {
  for_box(shape.x0, shape.y0, shape.x1, shape.y1, [&](int column, int row) { (*this)(column, row) = shape.paint; });
}

void Canvas::ellipse(const PaintedEllipse& shape) {
  const Eigen::Array2d center(shape.x, shape.y), radius(shape.radius_x, shape.radius_y);
  const Eigen::Array2d low = center - radius, high = center + radius;
  for_box(low.x(), low.y(), high.x(), high.y(), [&](int column, int row) {
    const Eigen::Array2d p = position(column, row).cast<double>().array();
    if (((p - center) / radius).square().sum() <= 1.0) (*this)(column, row) = shape.paint;
  });
}

void Canvas::line(const PaintedLine& shape) {
  const double aspect = static_cast<double>(width_) / height_;  // distances are measured in heights
  const Eigen::Vector2d a(shape.x0 * aspect, shape.y0), b(shape.x1 * aspect, shape.y1), direction = b - a;
  const double half = shape.thickness / 2, length2 = std::max(direction.squaredNorm(), 1e-12);
  const Eigen::Vector2d low = a.cwiseMin(b).array() - half, high = a.cwiseMax(b).array() + half;
  for_box(low.x() / aspect, low.y(), high.x() / aspect, high.y(), [&](int column, int row) {
    const Eigen::Vector2f q = position(column, row);
    const Eigen::Vector2d p(q.x() * aspect, q.y());
    const double t = std::clamp((p - a).dot(direction) / length2, 0.0, 1.0);
    if ((a + t * direction - p).norm() <= half) (*this)(column, row) = shape.paint;
  });
}

void Canvas::triangle(const PaintedTriangle& shape) {
  const Eigen::Vector2d low = shape.a.cwiseMin(shape.b).cwiseMin(shape.c);
  const Eigen::Vector2d high = shape.a.cwiseMax(shape.b).cwiseMax(shape.c);
  const auto side = [](const Eigen::Vector2d& p, const Eigen::Vector2d& q, const Eigen::Vector2d& r) {
    return (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
  };
  for_box(low.x(), low.y(), high.x(), high.y(), [&](int column, int row) {
    const Eigen::Vector2d p = position(column, row).cast<double>();
    const double ab = side(shape.a, shape.b, p), bc = side(shape.b, shape.c, p), ca = side(shape.c, shape.a, p);
    if (std::min({ab, bc, ca}) >= 0.0 || std::max({ab, bc, ca}) <= 0.0) (*this)(column, row) = shape.paint;
  });
}

void Canvas::gradient(const PaintedGradient& shape) {
  for_box(0.0, shape.y0, 1.0, shape.y1, [&](int column, int row) {
    const double t = std::clamp((position(column, row).y() - shape.y0) / (shape.y1 - shape.y0), 0.0, 1.0);
    (*this)(column, row) = shape.top + static_cast<float>(t) * (shape.bottom - shape.top);
  });
}

TextureImage Canvas::image(double contrast) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Paint& paint : pixels_) sum += paint.cast<double>();
  const Paint mean = (sum / static_cast<double>(pixels_.size())).cast<float>();
  TextureImage result(width_, height_);
  for (std::size_t i = 0; i < pixels_.size(); ++i) {
    const Paint p = mean + static_cast<float>(contrast) * (pixels_[i] - mean);
    result.pixels[i] = {to_byte(p.x()), to_byte(p.y()), to_byte(p.z()), 255};
  }
  return result;
}

}  // namespace lapis::simulator
