#include "common/mapping/model/voxel_map.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lapis::mapping {
VoxelMap::VoxelMap(double resolution_m) : resolution_m_(resolution_m) {
  if (!(resolution_m >= kMinResolution_m && resolution_m <= kMaxResolution_m))
    throw std::runtime_error("map resolution " + std::to_string(resolution_m) + " m is outside [0.02, 0.5] m");
}

VoxelIndex VoxelMap::index_of(const Eigen::Vector3d& p_map) const {
  const auto cell = [this](double x) { return static_cast<std::int32_t>(std::floor(x / resolution_m_)); };
  return {cell(p_map.x()), cell(p_map.y()), cell(p_map.z())};
}

Eigen::Vector3d VoxelMap::center_of(const VoxelIndex& voxel) const {
  return Eigen::Vector3d(voxel.x + 0.5, voxel.y + 0.5, voxel.z + 0.5) * resolution_m_;
}

void VoxelMap::add(const FrameVotes& votes) {
  for (const BlockVotes& of_block : votes.blocks) blocks_[of_block.block].add(of_block.misses, votes.hits_of(of_block));
}

void VoxelMap::subtract(const FrameVotes& votes) {
  for (const BlockVotes& of_block : votes.blocks) {
    const auto block = blocks_.find(of_block.block);
    if (block == blocks_.end() || !block->second.subtract(of_block.misses, votes.hits_of(of_block)))
      throw std::logic_error("VoxelMap::subtract: votes that were never added");
    if (block->second.is_empty()) blocks_.erase(block);
  }
}

const VoxelBlock* VoxelMap::find(const BlockIndex& block) const {
  const auto it = blocks_.find(block);
  return it == blocks_.end() ? nullptr : &it->second;
}

VoxelCounts VoxelMap::read(const VoxelIndex& voxel) const {
  VoxelCounts counts;
  if (const VoxelBlock* block = find(block_of(voxel))) block->read(offset_in_block(voxel), counts);
  return counts;
}

void VoxelMap::set_block(const BlockIndex& index, VoxelBlock block) {
  if (block.is_empty())
    blocks_.erase(index);
  else
    blocks_.insert_or_assign(index, std::move(block));
}

std::vector<BlockIndex> VoxelMap::sorted_blocks() const {
  std::vector<BlockIndex> indices;
  indices.reserve(blocks_.size());
  for (const auto& [index, block] : blocks_) indices.push_back(index);
  std::sort(indices.begin(), indices.end());
  return indices;
}

std::size_t VoxelMap::bytes() const {
  std::size_t total = blocks_.bucket_count() * sizeof(void*);
  for (const auto& [index, block] : blocks_) total += block.bytes() + sizeof(index) + sizeof(void*);
  return total;
}

bool VoxelMap::operator==(const VoxelMap& other) const {
  if (resolution_m_ != other.resolution_m_ || blocks_.size() != other.blocks_.size()) return false;
  return std::all_of(blocks_.begin(), blocks_.end(), [&](const auto& entry) {
    const VoxelBlock* theirs = other.find(entry.first);
    return theirs != nullptr && entry.second == *theirs;
  });
}

}  // namespace lapis::mapping
