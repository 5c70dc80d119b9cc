#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "planner/core/space/sparse_grid.hpp"

namespace lapis::planner {

/// Exact Euclidean distance between centres from every cell to the nearest cell of one value (the sources), up to a
/// reach. Chunks within reach of a cell that became or ceased to be a source are computed anew, in two passes (along
/// rows, then along columns): no state to go wrong, and the work is bounded by the change.
class DistanceField {
 public:
  /// @param source value of cells whose distance is 0. @param reach larger distances read as this [cells], in [1, 255].
  DistanceField(std::int8_t source, int reach);

  /// `changed` names every cell of `values` that is not what it was at the last call; others do no harm.
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
