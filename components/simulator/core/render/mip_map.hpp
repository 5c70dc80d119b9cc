#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// A texture with ever coarser copies of itself [Williams, SIGGRAPH 1983]: every level has half the size of the one
/// before, rounded down, until one side is a single texel.
class MipMap {
 public:
  explicit MipMap(std::shared_ptr<const TextureImage> texture);

  int levels() const { return 1 + static_cast<int>(coarser_.size()); }
  /// Size of level 0 [texels].
  int width() const { return finest_->width; }
  int height() const { return finest_->height; }
  /// Texels that N bilinear samples mix, and their weights.
  template <std::size_t N>
  struct Neighbours {
    std::array<std::array<std::uint32_t, N>, 4> texels;  ///< row by row; the bytes of each are in one word
    std::array<std::uint32_t, N> right, down;            ///< weights of the second column and row, in 1/256
  };
  /// Neighbours at coordinates that repeat with period 1; (0, 0) is the lower left corner. Weights are in fixed point,
  /// so they are the same on every machine. The loops run over samples, so that a compiler can vectorise them.
  template <std::size_t N>
  Neighbours<N> neighbours(int level_index, const std::array<float, N>& x, const std::array<float, N>& y) const {
    const TextureImage& image = level(level_index);
    Neighbours<N> out;
    std::array<std::array<int, N>, 4> index;
    for (std::size_t i = 0; i < N; ++i) {
      // Subtracting the floor keeps huge coordinates in range; rounding may still give exactly 1.
      const Pair u = pair(std::min(x[i] - std::floor(x[i]), 0.999999F), image.width);
      const Pair v = pair(std::min(1.0F - (y[i] - std::floor(y[i])), 0.999999F), image.height);
      index[0][i] = v.first * image.width + u.first;
      index[1][i] = v.first * image.width + u.second;
      index[2][i] = v.second * image.width + u.first;
      index[3][i] = v.second * image.width + u.second;
      out.right[i] = u.weight;
      out.down[i] = v.weight;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      for (std::size_t i = 0; i < N; ++i)
        out.texels[k][i] = std::bit_cast<std::uint32_t>(image.pixels[static_cast<std::size_t>(index[k][i])]);
    }
    return out;
  }

 private:
  static constexpr int kOne = 256;  // one texel in fixed point

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
