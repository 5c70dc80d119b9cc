#include "planner/core/information/information_field.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>

#include <tbb/parallel_for.h>

namespace lapis::planner {

using mapping::BlockIndex;
using mapping::kBlockVoxels;

namespace {

constexpr std::array<std::array<std::int32_t, 3>, 6> kFaceSteps{
    {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};

}  // namespace

template <class Real>
BasicInformationField<Real>::BasicInformationField(double resolution_m, const mapping::SensorModel& model,
                                                   const RayModel& ray)
    : resolution_m_(mapping::VoxelMap(resolution_m).resolution_m()), measure_(model, ray),
      unknown_(share_if_uniform(make_block({}))) {}

template <class Real>
void BasicInformationField<Real>::update(const mapping::VoxelMap& map, std::span<const BlockIndex> changed) {
  if (map.resolution_m() != resolution_m_)
    throw std::invalid_argument("the map's resolution is not that of the information field");
  const std::vector<BlockIndex> touched = with_neighbours(changed);
  std::vector<BlockPtr> blocks(touched.size());
  tbb::parallel_for(std::size_t{0}, touched.size(), [&](std::size_t i) {
    static const mapping::VoxelBlock kUnobserved;
    const mapping::VoxelBlock* found = map.find(touched[i]);
    const mapping::VoxelBlock& voxels = found == nullptr ? kUnobserved : *found;
    auto block = make_block(voxels);
    continue_surfaces(map, touched[i], voxels, *block);
    blocks[i] = std::move(block);
  });
  for (std::size_t i = 0; i < touched.size(); ++i) {
    BlockPtr block = share_if_uniform(std::move(blocks[i]));
    if (block != unknown_) {
      blocks_[touched[i]] = std::move(block);
    } else {
      blocks_.erase(touched[i]);
    }
  }
}

/// The changed blocks and, if surfaces continue into them, the blocks beside them.
template <class Real>
std::vector<BlockIndex> BasicInformationField<Real>::with_neighbours(std::span<const BlockIndex> changed) const {
  std::vector<BlockIndex> blocks(changed.begin(), changed.end());
  if (measure_.ray().surface_occupied <= 0.0) return blocks;
  for (const BlockIndex& index : changed) {
    for (const auto& step : kFaceSteps) blocks.push_back({index.x + step[0], index.y + step[1], index.z + step[2]});
  }
  std::sort(blocks.begin(), blocks.end());
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  return blocks;
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

/// Applies RayModel::surface_occupied to voxels never observed.
template <class Real>
void BasicInformationField<Real>::continue_surfaces(const mapping::VoxelMap& map, const BlockIndex& index,
                                                    const mapping::VoxelBlock& voxels, Block& block) const {
  if (measure_.ray().surface_occupied <= 0.0) return;
  const auto is_occupied = [&](const mapping::VoxelIndex& voxel) {
    const mapping::VoxelBlock* holder = block_of(voxel) == index ? &voxels : map.find(block_of(voxel));
    const int offset = offset_in_block(voxel);
    if (holder == nullptr || !holder->has_hits(offset)) return false;
    mapping::VoxelCounts counts;
    holder->read(offset, counts);
    return measure_.is_occupied(counts);
  };
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    if (voxels.is_observed(offset)) continue;
    const mapping::VoxelIndex v = voxel_at(index, offset);
    const bool is_beside = std::any_of(kFaceSteps.begin(), kFaceSteps.end(), [&](const auto& step) {
      return is_occupied({v.x + step[0], v.y + step[1], v.z + step[2]});
    });
    if (is_beside)
      block.free[static_cast<std::size_t>(offset)] = static_cast<Real>(1.0 - measure_.ray().surface_occupied);
  }
}

template <class Real>
std::shared_ptr<typename BasicInformationField<Real>::Block> BasicInformationField<Real>::make_block(
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
