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

/// Cells along one edge of a chunk.
inline constexpr std::int32_t kChunkEdge = 32;

/// Chunk that contains a cell.
constexpr Cell chunk_of(Cell c) { return {c.x >> 5, c.y >> 5}; }

/// A value for every cell of the plane. Memory is taken in chunks of 32 x 32 cells where values differ from the
/// default, plus one pointer for every chunk of the box around them. References stay valid.
template <class T>
class SparseGrid {
 public:
  explicit SparseGrid(T default_value = {}) : default_(std::move(default_value)) {}

  const T& at(Cell c) const {
    const Chunk* chunk = find(chunk_of(c));
    return chunk != nullptr ? (*chunk)[offset(c)] : default_;
  }
  /// The cell's value to write to.
  T& operator[](Cell c) { return make(chunk_of(c))[offset(c)]; }
  void set(Cell c, const T& value) {
    if (!(at(c) == value)) (*this)[c] = value;
  }

  /// Memory [bytes].
  std::size_t bytes() const { return chunks_.size() * sizeof(chunks_[0]) + count_ * sizeof(Chunk); }

 private:
  using Chunk = std::array<T, static_cast<std::size_t>(kChunkEdge) * kChunkEdge>;

  static std::size_t offset(Cell c) { return static_cast<std::size_t>((c.y & 31) << 5 | (c.x & 31)); }
  bool contains(Cell chunk) const {
    return chunk.x >= low_.x && chunk.y >= low_.y && chunk.x < high_.x && chunk.y < high_.y;
  }
  std::size_t slot(Cell chunk) const {
    return static_cast<std::size_t>(chunk.y - low_.y) * static_cast<std::size_t>(high_.x - low_.x) +
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
    SparseGrid wider;
    const bool is_first = chunks_.empty();
    wider.low_ = is_first ? chunk : Cell{std::min(low_.x, chunk.x), std::min(low_.y, chunk.y)};
    wider.high_ = is_first ? chunk + Cell{1, 1} : Cell{std::max(high_.x, chunk.x + 1), std::max(high_.y, chunk.y + 1)};
    wider.chunks_.resize(wider.slot({wider.low_.x, wider.high_.y}));
    for (Cell c = low_; c.y < high_.y; ++c.y)
      for (c.x = low_.x; c.x < high_.x; ++c.x) wider.chunks_[wider.slot(c)] = std::move(chunks_[slot(c)]);
    low_ = wider.low_;
    high_ = wider.high_;
    chunks_ = std::move(wider.chunks_);
  }

  T default_;
  Cell low_, high_;  ///< box of the chunks; high_ is one beyond
  std::vector<std::unique_ptr<Chunk>> chunks_;
  std::size_t count_ = 0;
};

}  // namespace lapis::planner
