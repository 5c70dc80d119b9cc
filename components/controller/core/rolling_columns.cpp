#include "controller/core/rolling_columns.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace lapis::controller {
namespace {

constexpr std::int32_t kNone = -1;

}  // namespace

RollingColumns::RollingColumns(int reach_cells)
    : mask_(std::bit_ceil(static_cast<unsigned>(std::max(reach_cells, 1))) - 1U),
      column_at_(std::size_t{mask_ + 1} * (mask_ + 1), kNone) {}

std::size_t RollingColumns::place_of(std::int32_t x, std::int32_t y) const {
  return std::size_t{static_cast<unsigned>(y) & mask_} * (mask_ + 1) + (static_cast<unsigned>(x) & mask_);
}

ColumnPoint& RollingColumns::at(std::int32_t x, std::int32_t y, std::int32_t z) {
  std::int32_t& place = column_at_[place_of(x, y)];
  if (place == kNone) {
    place = static_cast<std::int32_t>(columns_.size());
    columns_.push_back({x, y, {}});
  }
  PointColumn& column = columns_[static_cast<std::size_t>(place)];
  if (column.x != x || column.y != y) column = {x, y, {}};
  const auto is_it = [z](const ColumnPoint& point) { return point.z == z; };
  const auto known = std::find_if(column.points.begin(), column.points.end(), is_it);
  return known != column.points.end()
             ? *known
             : column.points.emplace_back(ColumnPoint{z, -std::numeric_limits<double>::infinity(), 0});
}

/// Removes a column; the last column fills the gap.
void RollingColumns::remove(std::size_t column) {
  column_at_[place_of(columns_[column].x, columns_[column].y)] = kNone;
  if (column + 1 != columns_.size()) {
    columns_[column] = std::move(columns_.back());
    column_at_[place_of(columns_[column].x, columns_[column].y)] = static_cast<std::int32_t>(column);
  }
  columns_.pop_back();
}

void RollingColumns::clear() {
  std::fill(column_at_.begin(), column_at_.end(), kNone);
  columns_.clear();
}

}  // namespace lapis::controller
