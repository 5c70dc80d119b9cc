#pragma once

#include <memory>
#include <vector>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// A texture with ever coarser copies of itself [Williams, SIGGRAPH 1983]: every level is half the one before, rounded
/// down, until one side is a texel.
class MipMap {
 public:
  explicit MipMap(std::shared_ptr<const TextureImage> texture);

  int levels() const { return 1 + static_cast<int>(coarser_.size()); }
  /// Size of level 0 [texels].
  int width() const { return finest_->width; }
  int height() const { return finest_->height; }
  /// Bilinear sample at a coordinate that repeats with period 1; (0, 0) is the lower left corner. Fixed-point, so the
  /// same on every machine.
  geometry::Rgb8 sample(int level_index, float x, float y) const;

 private:
  const TextureImage& level(int index) const {
    return index == 0 ? *finest_ : coarser_[static_cast<std::size_t>(index) - 1];
  }

  std::shared_ptr<const TextureImage> finest_;  // shared with the mesh
  std::vector<TextureImage> coarser_;
};

}  // namespace lapis::simulator
