#pragma once

#include <cstdint>
#include <vector>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// A texture with ever coarser copies of itself [Williams, SIGGRAPH 1983]. Sides are scaled up to powers of two, so
/// that coordinates wrap by masking. Every level is half the one before, down to one texel.
class MipMap {
 public:
  explicit MipMap(const TextureImage& texture);

  int levels() const { return static_cast<int>(levels_.size()); }
  /// Size of level 0 [texels].
  int width() const { return levels_.front().width; }
  int height() const { return levels_.front().height; }
  const TextureImage& level(int index) const { return levels_[static_cast<std::size_t>(index)]; }
  /// Bilinear sample at a coordinate that repeats with period 1; (0, 0) is the lower left corner. Fixed-point, so the
  /// same on every machine.
  geometry::Rgb8 sample(int level, float x, float y) const;
  std::size_t bytes() const;

 private:
  std::vector<TextureImage> levels_;
};

}  // namespace lapis::simulator
