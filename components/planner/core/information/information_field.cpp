#include "planner/core/information/information_field.hpp"

#include <algorithm>
#include <stdexcept>

#include <tbb/parallel_for.h>

namespace lapis::planner {

using mapping::BlockIndex;
using mapping::kBlockVoxels;

template <class Real>
BasicInformationField<Real>::BasicInformationField(double resolution_m, const mapping::SensorModel& model,
                                                   const RayModel& ray)
    : resolution_m_(mapping::VoxelMap(resolution_m).resolution_m()), measure_(model, ray),
      unknown_(share_if_uniform(make_block({}))) {}

template <class Real>
void BasicInformationField<Real>::update(const mapping::VoxelMap& map, std::span<const BlockIndex> changed) {
  if (map.resolution_m() != resolution_m_)
    throw std::invalid_argument("the map's resolution is not that of the information field");
  std::vector<BlockPtr> blocks(changed.size());
  tbb::parallel_for(std::size_t{0}, changed.size(), [&](std::size_t i) {
    if (const mapping::VoxelBlock* voxels = map.find(changed[i])) blocks[i] = make_block(*voxels);
  });
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (blocks[i]) {
      blocks_[changed[i]] = share_if_uniform(std::move(blocks[i]));
    } else {
      blocks_.erase(changed[i]);
    }
  }
}

template <class Real>
void BasicInformationField<Real>::rebuild(const mapping::VoxelMap& map) {
  blocks_.clear();
  update(map, map.sorted_blocks());
}

template <class Real>
void BasicInformationField<Real>::set_block(const BlockIndex& index,
                                            std::span<const CellInformation, kBlockVoxels> cells) {
  auto block = std::make_shared<Block>();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    block->free[i] = static_cast<Real>(cells[i].free);
    block->gain[i] = static_cast<Real>(cells[i].gain);
  }
  blocks_[index] = share_if_uniform(std::move(block));
}

template <class Real>
const typename BasicInformationField<Real>::Block& BasicInformationField<Real>::block(const BlockIndex& index) const {
  const auto found = blocks_.find(index);
  return found == blocks_.end() ? *unknown_ : *found->second;
}

template <class Real>
CellInformation BasicInformationField<Real>::cell(const mapping::VoxelIndex& voxel) const {
  const Block& found = block(block_of(voxel));
  const auto offset = static_cast<std::size_t>(offset_in_block(voxel));
  return {found.free[offset], found.gain[offset]};
}

template <class Real>
typename BasicInformationField<Real>::BlockPtr BasicInformationField<Real>::make_block(
    const mapping::VoxelBlock& voxels) const {
  auto block = std::make_shared<Block>();
  const bool is_uniform = voxels.is_uniform();
  mapping::VoxelCounts counts;
  CellInformation cell;
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    if (offset == 0 || !is_uniform) {
      voxels.read(offset, counts);
      cell = measure_.of(counts);
    }
    block->free[static_cast<std::size_t>(offset)] = static_cast<Real>(cell.free);
    block->gain[static_cast<std::size_t>(offset)] = static_cast<Real>(cell.gain);
  }
  return block;
}

template <class Real>
typename BasicInformationField<Real>::BlockPtr BasicInformationField<Real>::share_if_uniform(BlockPtr block) {
  const auto is_uniform = [](const auto& values) {
    return std::all_of(values.begin(), values.end(), [&](Real value) { return value == values.front(); });
  };
  if (!is_uniform(block->free) || !is_uniform(block->gain)) return block;
  return uniform_.try_emplace({block->free.front(), block->gain.front()}, std::move(block)).first->second;
}

template class BasicInformationField<float>;
template class BasicInformationField<double>;

}  // namespace lapis::planner
