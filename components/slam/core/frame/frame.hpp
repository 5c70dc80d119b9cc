#pragma once

#include <vector>

#include "common/geometry/image.hpp"
#include "common/geometry/pinhole_camera.hpp"
#include "common/time/time.hpp"
#include "slam/core/config.hpp"
#include "slam/core/frame/feature_extractor.hpp"

namespace lapis::slam {

/// Registered colour and depth, in the camera's optical frame.
struct RgbdFrame {
  time::Time stamp;  ///< of colour
  geometry::PinholeCamera camera;
  geometry::GrayImage gray;      ///< camera.width x camera.height
  geometry::DepthImage depth;    ///< same size; metres, 0 = none
  time::Duration depth_delay{};  ///< how much later than colour depth was measured
};

/// Finds the features near a pixel.
class FeatureIndex {
 public:
  FeatureIndex() = default;
  FeatureIndex(const std::vector<Feature>& features, int width, int height);

  /// Appends to `found` the indices of features at most `radius_px` from `pixel` in x and in y, in a fixed order.
  void find(const Eigen::Vector2d& pixel, double radius_px, std::vector<int>& found) const;

 private:
  struct Entry {
    Eigen::Vector2d pixel;
    int feature = 0;
  };
  std::size_t cell_of(const Eigen::Vector2d& pixel) const;

  int columns_ = 0;
  int rows_ = 0;
  std::vector<Entry> entries_;       // cell after cell, row by row
  std::vector<std::size_t> begins_;  // begin of each cell in entries_, and the end of the last one
};

/// What tracking uses of an RgbdFrame. It refers to the images of the RgbdFrame, which must outlive it.
struct Frame {
  const RgbdFrame* input = nullptr;
  std::vector<Feature> features;
  FeatureIndex index;
  int features_with_depth = 0;
};

/// z-depth [m] at a pixel, interpolated between its four neighbours; 0 when one is missing or they belong to
/// different surfaces. Inverse depth is linear on a plane, so planes are interpolated exactly.
double interpolate_depth(const NoiseConfig& config, const geometry::DepthImage& depth, const Eigen::Vector2d& pixel);

Frame make_frame(const RgbdFrame& input, const FeatureExtractor& extractor, const NoiseConfig& config);
/// Reads the features' depths again: the depth image of the frame's input has changed.
void renew_depths(const NoiseConfig& config, Frame& frame);

}  // namespace lapis::slam
