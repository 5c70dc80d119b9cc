#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
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
  /// What a bilinear sample mixes.
  struct Neighbours {
    std::array<std::uint32_t, 4> texels;  ///< the bytes of each in one word; row by row
    std::uint32_t right, down;            ///< weights of the second column and row, in 1/256
  };
  /// At a coordinate that repeats with period 1; (0, 0) is the lower left corner. Weights are in fixed point, so the
  /// same on every machine.
  Neighbours neighbours(int level_index, float x, float y) const {
    const TextureImage& image = level(level_index);
    // The subtraction of the floor keeps huge coordinates in range; rounding may still give exactly 1.
    const Pair u = pair(std::min(x - std::floor(x), 0.999999F), image.width);
    const Pair v = pair(std::min(1.0F - (y - std::floor(y)), 0.999999F), image.height);
    const auto texel = [&image](int column, int row) { return std::bit_cast<std::uint32_t>(image(column, row)); };
    return {{texel(u.first, v.first), texel(u.second, v.first), texel(u.first, v.second), texel(u.second, v.second)},
            u.weight,
            v.weight};
  }

 private:
  static constexpr int kOne = 256;  // a texel

  /// Neighbours on one axis, and the weight of the second.
  struct Pair {
    int first, second;
    std::uint32_t weight;
  };
  /// @param position in [0, 1)
  static Pair pair(float position, int size) {
    const int fixed = static_cast<int>(position * static_cast<float>(size * kOne)) - kOne / 2;
    const int texel = fixed >> 8;  // -1 to size - 1: centres are at half texels
    return {texel < 0 ? texel + size : texel, texel + 1 == size ? 0 : texel + 1,
            static_cast<std::uint32_t>(fixed & (kOne - 1))};
  }

  const TextureImage& level(int index) const {
    return index == 0 ? *finest_ : coarser_[static_cast<std::size_t>(index) - 1];
  }

  std::shared_ptr<const TextureImage> finest_;  // shared with the mesh
  std::vector<TextureImage> coarser_;
};

}  // namespace lapis::simulator
