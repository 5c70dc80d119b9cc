#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "planner/core/space/sparse_grid.hpp"

namespace lapis::planner {

/// Exact Euclidean distance between centres, from every cell to the nearest cell of one value (the sources), up to a
/// reach. Chunks within reach of a cell that became or ceased to be a source are recomputed in two passes, along rows
/// and then along columns: there is no intermediate state that could become inconsistent, and the work is bounded by
/// the change.
class DistanceField {
 public:
  /// @param source value of the cells whose distance is 0
  /// @param reach distances above this read as this [cells], in [1, 255]
  DistanceField(std::int8_t source, int reach);

  /// @param changed every cell of `values` that has changed since the last call; further cells do no harm
  void update(const SparseGrid<std::int8_t>& values, std::span<const Cell> changed);
  /// Square of the distance, at most reach^2 [cells^2].
  int squared(Cell c) const { return squared_.at(c); }
  std::size_t bytes() const { return squared_.bytes(); }

 private:
  void compute_chunk(const SparseGrid<std::int8_t>& values, Cell chunk);

  std::int8_t source_;
  int reach_;
  SparseGrid<std::uint16_t> squared_;
};

}  // namespace lapis::planner
