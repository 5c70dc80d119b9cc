#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lapis::controller {

/// A remembered point of a column.
struct ColumnPoint {
  std::int32_t z = 0;   ///< index of the voxel
  double seen_s = 0.0;  ///< time of the last hit (LocalMap's time that counts); minus infinity: none yet
  int misses = 0;       ///< images that saw through it since then
};

/// Points above one cell of the plane, in the order of insertion.
struct PointColumn {
  std::int32_t x = 0, y = 0;  ///< index of the cell
  std::vector<ColumnPoint> points;
};

/// Columns around a moving position. A dense grid that wraps around maps cells to columns: cells that are a whole
/// period apart share a place, where the newer column replaces the older one. The columns are stored without gaps, so
/// that iterating over them is fast.
class RollingColumns {
 public:
  /// @param reach_cells columns less than this distance apart in x and in y never replace each other; at least 1
  explicit RollingColumns(int reach_cells);

  /// The point of this voxel, which is added if it is missing.
  ColumnPoint& at(std::int32_t x, std::int32_t y, std::int32_t z);
  /// All columns, in no particular order; each has at least one point.
  const std::vector<PointColumn>& columns() const { return columns_; }
  /// Calls keep(column), which may remove points; columns for which it returns false, or that have no points left, are
  /// removed.
  template <class Keep>
  void keep_if(const Keep& keep) {
    for (std::size_t i = 0; i < columns_.size();) {
      if (keep(columns_[i]) && !columns_[i].points.empty()) {
        ++i;
      } else {
        remove(i);
      }
    }
  }
  void clear();

 private:
  std::size_t place_of(std::int32_t x, std::int32_t y) const;
  void remove(std::size_t column);

  unsigned mask_;
  std::vector<std::int32_t> column_at_;  ///< index in columns_ by place; -1: none
  std::vector<PointColumn> columns_;
};

}  // namespace lapis::controller
