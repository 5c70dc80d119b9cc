#include "common/mapping/voxel_map.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>

namespace lapis::mapping {
namespace {

template <class Visitor>
void for_each_pass(const BlockVotes& votes, Visitor&& visit) {
  for (std::size_t word = 0; word < votes.passes.size(); ++word)
    for (std::uint64_t bits = votes.passes[word]; bits != 0; bits &= bits - 1)
      visit(static_cast<int>(word) * 64 + std::countr_zero(bits));
}

}  // namespace

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
  for (const BlockVotes& of_block : votes.blocks) {
    VoxelBlock& block = blocks_[of_block.block];
    for_each_pass(of_block, [&](int offset) { block.add_pass(offset, kOneVote); });
    for (std::uint32_t i = of_block.hits_begin; i < of_block.hits_end; ++i)
      block.add_hit(votes.hits[i].offset, votes.hits[i].label, votes.hits[i].weight);
  }
}

void VoxelMap::subtract(const FrameVotes& votes) {
  for (const BlockVotes& of_block : votes.blocks) {
    const auto it = blocks_.find(of_block.block);
    if (it == blocks_.end()) throw std::logic_error("VoxelMap::subtract: votes that were never added");
    VoxelBlock& block = it->second;
    bool was_there = true;
    for_each_pass(of_block, [&](int offset) { was_there &= block.subtract_pass(offset, kOneVote); });
    for (std::uint32_t i = of_block.hits_begin; i < of_block.hits_end; ++i)
      was_there &= block.subtract_hit(votes.hits[i].offset, votes.hits[i].label, votes.hits[i].weight);
    if (!was_there) throw std::logic_error("VoxelMap::subtract: votes that were never added");
    if (block.is_empty()) blocks_.erase(it);
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
  std::size_t total = 0;
  for (const auto& [index, block] : blocks_) total += block.bytes() + sizeof(index) + 2 * sizeof(void*);
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
