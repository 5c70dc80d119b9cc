#include "slam/core/frame.hpp"

#include <algorithm>
#include <cmath>

#include "slam/core/noise_model.hpp"

namespace lapis::slam {
namespace {

constexpr double kCellSize_px = 20.0;
// Neighbouring pixels whose depths differ by more than this share lie on different surfaces.
constexpr float kMaxDepthStep = 0.05F;

int cell_of(double coordinate, int cells) {
  return std::clamp(static_cast<int>(std::floor(coordinate / kCellSize_px)), 0, cells - 1);
}

}  // namespace

FeatureIndex::FeatureIndex(const std::vector<Feature>& features, int width, int height)
    : columns_(static_cast<int>(width / kCellSize_px) + 1), rows_(static_cast<int>(height / kCellSize_px) + 1),
      cells_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
  pixels_.reserve(features.size());
  for (std::size_t i = 0; i < features.size(); ++i) {
    const Eigen::Vector2d& pixel = features[i].pixel;
    pixels_.push_back(pixel);
    const int cell = cell_of(pixel.y(), rows_) * columns_ + cell_of(pixel.x(), columns_);
    cells_[static_cast<std::size_t>(cell)].push_back(static_cast<int>(i));
  }
}

void FeatureIndex::find(const Eigen::Vector2d& pixel, double radius_px, std::vector<int>& found) const {
  if (cells_.empty()) return;
  const int first_column = cell_of(pixel.x() - radius_px, columns_);
  const int last_column = cell_of(pixel.x() + radius_px, columns_);
  const int last_row = cell_of(pixel.y() + radius_px, rows_);
  for (int row = cell_of(pixel.y() - radius_px, rows_); row <= last_row; ++row) {
    for (int column = first_column; column <= last_column; ++column) {
      const int cell = row * columns_ + column;
      for (const int i : cells_[static_cast<std::size_t>(cell)]) {
        const Eigen::Vector2d offset = pixels_[static_cast<std::size_t>(i)] - pixel;
        if (offset.cwiseAbs().maxCoeff() <= radius_px) found.push_back(i);
      }
    }
  }
}

double interpolate_depth(const NoiseConfig& config, const geometry::DepthImage& depth, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= depth.width || y + 1 >= depth.height) return 0.0;
  const float* upper = &depth(x, y);
  const float* lower = &depth(x, y + 1);
  const auto [low, high] = std::minmax({upper[0], upper[1], lower[0], lower[1]});
  if (!is_depth(config, low) || !is_depth(config, high) || high - low > kMaxDepthStep * low) return 0.0;
  const double a = pixel.x() - x;
  const double b = pixel.y() - y;
  return 1.0 / ((1.0 - b) * ((1.0 - a) / upper[0] + a / upper[1]) + b * ((1.0 - a) / lower[0] + a / lower[1]));
}

Frame make_frame(const RgbdFrame& input, const FeatureExtractor& extractor, const NoiseConfig& config) {
  Frame frame;
  frame.input = &input;
  frame.features = extractor.extract(input.gray);
  for (Feature& feature : frame.features) {
    feature.depth_m = interpolate_depth(config, input.depth, feature.pixel);
    if (feature.depth_m > 0.0) ++frame.features_with_depth;
  }
  frame.index = FeatureIndex(frame.features, input.camera.width, input.camera.height);
  return frame;
}

}  // namespace lapis::slam
