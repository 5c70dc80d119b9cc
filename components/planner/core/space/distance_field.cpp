#include "planner/core/space/distance_field.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include "common/mapping/model/column_projection.hpp"

namespace lapis::planner {
namespace {

/// Distance from each of the `kChunkEdge` middle cells of a row to the nearest source in the row, at most `reach`
/// [cells].
void scan_row(const SparseGrid<std::int8_t>& values, std::int8_t source, Cell first, int reach, std::int32_t* out) {
  std::int32_t since = reach;
  for (std::int32_t i = -reach; i < kChunkEdge; ++i) {
    since = values.at({first.x + i, first.y}) == source ? 0 : std::min(since + 1, reach);
    if (i >= 0) out[i] = since;
  }
  since = reach;
  for (std::int32_t i = kChunkEdge + reach - 1; i >= 0; --i) {
    since = values.at({first.x + i, first.y}) == source ? 0 : std::min(since + 1, reach);
    if (i < kChunkEdge) out[i] = std::min(out[i], since);
  }
}

}  // namespace

DistanceField::DistanceField(std::int8_t source, int reach)
    : source_(source), reach_(reach),
      squared_(static_cast<std::uint16_t>(source == mapping::kUnknown ? 0 : reach * reach)) {}

void DistanceField::update(const SparseGrid<std::int8_t>& values, std::span<const Cell> changed) {
  std::set<Cell> chunks;
  Cell last_low, last_high;
  for (const Cell& c : changed) {
    if ((values.at(c) == source_) == (squared(c) == 0)) continue;
    const Cell low = chunk_of(c - Cell{reach_, reach_}), high = chunk_of(c + Cell{reach_, reach_});
    if (!chunks.empty() && low == last_low && high == last_high) continue;
    for (Cell chunk = low; chunk.y <= high.y; ++chunk.y)
      for (chunk.x = low.x; chunk.x <= high.x; ++chunk.x) chunks.insert(chunk);
    last_low = low;
    last_high = high;
  }
  for (const Cell& chunk : chunks) compute_chunk(values, chunk);
}

void DistanceField::compute_chunk(const SparseGrid<std::int8_t>& values, Cell chunk) {
  const Cell first{chunk.x * kChunkEdge, chunk.y * kChunkEdge};
  const int rows = kChunkEdge + 2 * reach_;
  std::vector<std::int32_t> in_row(static_cast<std::size_t>(rows) * kChunkEdge);
  const auto row = [&](int y) { return in_row.data() + static_cast<std::ptrdiff_t>(y + reach_) * kChunkEdge; };
  for (int y = -reach_; y < kChunkEdge + reach_; ++y) scan_row(values, source_, {first.x, first.y + y}, reach_, row(y));
  std::array<std::int32_t, kChunkEdge> best;
  for (int y = 0; y < kChunkEdge; ++y) {
    best.fill(reach_ * reach_);
    for (int dy = -reach_; dy <= reach_; ++dy) {
      const std::int32_t* dx = row(y + dy);
      for (std::size_t x = 0; x < best.size(); ++x) best[x] = std::min(best[x], dx[x] * dx[x] + dy * dy);
    }
    for (int x = 0; x < kChunkEdge; ++x)
      squared_.set({first.x + x, first.y + y}, static_cast<std::uint16_t>(best[static_cast<std::size_t>(x)]));
  }
}

}  // namespace lapis::planner
