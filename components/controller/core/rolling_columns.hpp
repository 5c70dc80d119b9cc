#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lapis::controller {

/// A point of a column, remembered.
struct ColumnPoint {
  std::int32_t z = 0;   ///< of the voxel
  double seen_s = 0.0;  ///< time that counts of the last hit; minus infinity: none yet
  int misses = 0;       ///< images that looked through it since
};

/// Points above one cell of the plane, in the order in which they came.
struct PointColumn {
  std::int32_t x = 0, y = 0;  ///< of the cell
  std::vector<ColumnPoint> points;
};

/// Columns around a place that moves, found by a dense grid that rolls along: cells that are a whole turn of it apart
/// share a place, and the newer column takes it from the older one. Without gaps, so that a pass over all is fast.
class RollingColumns {
 public:
  /// @param reach_cells columns of less than this distance in x and in y never take each other's place, at least 1
  explicit RollingColumns(int reach_cells);

  /// The point of this voxel; made when it was not there.
  ColumnPoint& at(std::int32_t x, std::int32_t y, std::int32_t z);
  /// Of at least one point each, in no particular order.
  const std::vector<PointColumn>& columns() const { return columns_; }
  /// Calls keep(column), which may take points away; a column for which it is false, or that has no points left, goes.
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
  std::vector<std::int32_t> column_at_;  ///< by place; -1: none
  std::vector<PointColumn> columns_;
};

}  // namespace lapis::controller
