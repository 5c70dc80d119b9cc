#include "slam/core/frame/frame.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "slam/core/frame/noise_model.hpp"

namespace lapis::slam {
namespace {

constexpr double kCellSize_px = 20.0;
// Neighbouring pixels whose depths differ by more than this share belong to different surfaces.
constexpr float kMaxDepthStep = 0.05F;

int clamped_cell(double coordinate, int cells) {
  return std::clamp(static_cast<int>(std::floor(coordinate / kCellSize_px)), 0, cells - 1);
}

}  // namespace

FeatureIndex::FeatureIndex(const std::vector<Feature>& features, int width, int height)
    : columns_(static_cast<int>(width / kCellSize_px) + 1), rows_(static_cast<int>(height / kCellSize_px) + 1),
      entries_(features.size()), begins_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0) {
  for (const Feature& feature : features) ++begins_[cell_of(feature.pixel) + 1];
  std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
  std::vector<std::size_t> next(begins_.begin(), begins_.end() - 1);
  for (std::size_t i = 0; i < features.size(); ++i) {
    entries_[next[cell_of(features[i].pixel)]++] = {features[i].pixel, static_cast<int>(i)};
  }
}

std::size_t FeatureIndex::cell_of(const Eigen::Vector2d& pixel) const {
  const int cell = clamped_cell(pixel.y(), rows_) * columns_ + clamped_cell(pixel.x(), columns_);
  return static_cast<std::size_t>(cell);
}

void FeatureIndex::find(const Eigen::Vector2d& pixel, double radius_px, std::vector<int>& found) const {
  if (entries_.empty()) return;
  const Eigen::Vector2d reach(radius_px, radius_px);
  const auto columns = static_cast<std::size_t>(columns_);
  std::size_t first = cell_of(pixel - reach);
  const std::size_t last = cell_of(pixel + reach);
  const std::size_t width = last % columns - first % columns;
  for (; first <= last; first += columns) {  // the cells of a row are contiguous
    for (std::size_t i = begins_[first]; i < begins_[first + width + 1]; ++i) {
      const Entry& entry = entries_[i];
      if (std::abs(entry.pixel.x() - pixel.x()) <= radius_px && std::abs(entry.pixel.y() - pixel.y()) <= radius_px) {
        found.push_back(entry.feature);
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
  renew_depths(config, frame);
  frame.index = FeatureIndex(frame.features, input.camera.width, input.camera.height);
  return frame;
}

void renew_depths(const NoiseConfig& config, Frame& frame) {
  frame.features_with_depth = 0;
  for (Feature& feature : frame.features) {
    feature.depth_m = interpolate_depth(config, frame.input->depth, feature.pixel);
    if (feature.depth_m > 0.0) ++frame.features_with_depth;
  }
}

}  // namespace lapis::slam
