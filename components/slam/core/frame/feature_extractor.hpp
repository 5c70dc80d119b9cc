#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "slam/core/config.hpp"

namespace lapis::slam {

/// 256 bits of an ORB descriptor.
using Descriptor = std::array<std::uint64_t, 4>;

/// Corner with its ORB descriptor, at pixel coordinates of the full image.
struct Feature {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< [px]
  int octave = 0;                                   ///< pyramid level, 0 = finest
  double depth_m = 0.0;                             ///< 0 = none
  Descriptor descriptor{};
};

/// Corner candidate of one pyramid level.
struct Corner {
  int x = 0, y = 0;  ///< [px] of the level
  float score = 0.0F;
};

/// Chooses at most `count` corners: every cell of a grid with about `count` cells gets its best corner before any cell
/// gets its second best. They are in the order of rank in the cell, then score, then position, whatever the order of
/// the input.
std::vector<Corner> spread_corners(const std::vector<Corner>& corners, int width, int height, int count);

/// FAST corners on a pyramid, spread over a grid, with ORB descriptors [Rublee 2011].
class FeatureExtractor {
 public:
  explicit FeatureExtractor(const FeatureConfig& config);
  ~FeatureExtractor();

  /// Features of an image, coarser levels last; their depths are 0.
  std::vector<Feature> extract(const geometry::GrayImage& image) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lapis::slam
