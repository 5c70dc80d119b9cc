#include "semantic_mapper/core/provisional_area.hpp"

namespace lapis::semantic_mapper {
namespace {

using mapping::BlockVotes;
using mapping::kBlockEdge;

/// Voxels of a block that a frame has observed.
mapping::BlockMask observed(const BlockVotes& votes, const mapping::FrameVotes& frame) {
  mapping::BlockMask mask = votes.misses;
  for (const mapping::HitVote& hit : frame.hits_of(votes))
    mask[hit.offset / 64u] |= std::uint64_t{1} << hit.offset % 64u;
  return mask;
}

}  // namespace

void ProvisionalArea::set(std::size_t frame, const mapping::FrameVotes& votes) {
  Columns columns;
  for (const BlockVotes& of_block : votes.blocks) {
    const mapping::BlockMask mask = observed(of_block, votes);
    std::uint64_t cells = 0;
    for (int layer = 0; layer < kBlockEdge; ++layer) {  // a word of the mask is a layer
      if (mapping::is_in_band(of_block.block.z * kBlockEdge + layer, resolution_m_, band_))
        cells |= mask[static_cast<std::size_t>(layer)];
    }
    if (cells != 0) columns[{of_block.block.x, of_block.block.y}] |= cells;
  }
  ++changes_;
  seen_[frame].assign(columns.begin(), columns.end());
}

OccupancyGrid ProvisionalArea::grid() const {
  Columns all;
  for (const auto& [frame, columns] : seen_)
    for (const auto& [column, cells] : columns) all[column] |= cells;
  std::vector<GridCell> seen;
  for (const auto& [column, cells] : all)
    for (std::int32_t i = 0; i < kBlockEdge * kBlockEdge; ++i)
      if (cells >> i & 1u)
        seen.push_back({column.x * kBlockEdge + i % kBlockEdge, column.y * kBlockEdge + i / kBlockEdge, kFree});
  return make_grid(seen, resolution_m_);
}

}  // namespace lapis::semantic_mapper
