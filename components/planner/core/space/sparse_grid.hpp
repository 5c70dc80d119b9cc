#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "planner/core/space/cell.hpp"

namespace lapis::planner {

/// Number of cells along an edge of a chunk.
inline constexpr std::int32_t kChunkEdge = 32;

/// The chunk that contains a cell.
constexpr Cell chunk_of(Cell c) { return {c.x >> 5, c.y >> 5}; }

/// A value for every cell of the plane. Memory is allocated in chunks of 32 x 32 cells where values differ from the
/// default, plus one pointer for every chunk of the box around them. References to values stay valid.
template <class T>
class SparseGrid {
 public:
  explicit SparseGrid(T default_value = {}) : default_(std::move(default_value)) {}

  const T& at(Cell c) const {
    const Chunk* chunk = find(chunk_of(c));
    return chunk != nullptr ? (*chunk)[offset(c)] : default_;
  }
  /// The cell's value, for writing.
  T& operator[](Cell c) { return make(chunk_of(c))[offset(c)]; }
  void set(Cell c, const T& value) {
    if (!(at(c) == value)) (*this)[c] = value;
  }

  /// All cells with this value, which must not be the default; sorted.
  std::vector<Cell> cells_with(const T& value) const {
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < chunks_.size(); ++i) {
      if (!chunks_[i]) continue;
      const Cell chunk{low_.x + static_cast<std::int32_t>(i) % width_, low_.y + static_cast<std::int32_t>(i) / width_};
      for (std::int32_t k = 0; k < kChunkEdge * kChunkEdge; ++k) {
        const Cell cell{chunk.x * kChunkEdge + k % kChunkEdge, chunk.y * kChunkEdge + k / kChunkEdge};
        if ((*chunks_[i])[offset(cell)] == value) cells.push_back(cell);
      }
    }
    std::sort(cells.begin(), cells.end());
    return cells;
  }

  /// Memory [bytes].
  std::size_t bytes() const { return chunks_.size() * sizeof(chunks_[0]) + count_ * sizeof(Chunk); }

 private:
  using Chunk = std::array<T, static_cast<std::size_t>(kChunkEdge) * kChunkEdge>;

  static std::size_t offset(Cell c) { return static_cast<std::size_t>((c.y & 31) << 5 | (c.x & 31)); }
  bool contains(Cell chunk) const {  // coordinates below low_ wrap around to large ones
    return static_cast<std::uint32_t>(chunk.x - low_.x) < static_cast<std::uint32_t>(width_) &&
           static_cast<std::uint32_t>(chunk.y - low_.y) < static_cast<std::uint32_t>(height_);
  }
  std::size_t slot(Cell chunk) const {
    return static_cast<std::size_t>(chunk.y - low_.y) * static_cast<std::size_t>(width_) +
           static_cast<std::size_t>(chunk.x - low_.x);
  }
  const Chunk* find(Cell chunk) const { return contains(chunk) ? chunks_[slot(chunk)].get() : nullptr; }

  Chunk& make(Cell chunk) {
    if (!contains(chunk)) extend_to(chunk);
    std::unique_ptr<Chunk>& made = chunks_[slot(chunk)];
    if (!made) {
      made = std::make_unique<Chunk>();
      made->fill(default_);
      ++count_;
    }
    return *made;
  }

  void extend_to(Cell chunk) {
    const bool is_first = chunks_.empty();
    const Cell low = is_first ? chunk : Cell{std::min(low_.x, chunk.x), std::min(low_.y, chunk.y)};
    const std::int32_t width = is_first ? 1 : std::max(low_.x + width_, chunk.x + 1) - low.x;
    const std::int32_t height = is_first ? 1 : std::max(low_.y + height_, chunk.y + 1) - low.y;
    std::vector<std::unique_ptr<Chunk>> chunks(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (std::size_t i = 0; i < chunks_.size(); ++i) {
      const auto x = static_cast<std::size_t>(low_.x - low.x) + i % static_cast<std::size_t>(width_);
      const auto y = static_cast<std::size_t>(low_.y - low.y) + i / static_cast<std::size_t>(width_);
      chunks[y * static_cast<std::size_t>(width) + x] = std::move(chunks_[i]);
    }
    low_ = low;
    width_ = width;
    height_ = height;
    chunks_ = std::move(chunks);
  }

  T default_;
  Cell low_;                             ///< first chunk of the box
  std::int32_t width_ = 0, height_ = 0;  ///< of the box [chunks]
  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::size_t count_ = 0;
};

}  // namespace lapis::planner
