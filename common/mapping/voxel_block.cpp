#include "common/mapping/voxel_block.hpp"

#include <algorithm>

namespace lapis::mapping {

VoxelBlock::VoxelBlock(const VoxelBlock& other)
    : passes_(other.passes_), hits_(other.hits_ ? std::make_unique<Hits>(*other.hits_) : nullptr) {}

VoxelBlock& VoxelBlock::operator=(const VoxelBlock& other) {
  if (this != &other) *this = VoxelBlock(other);
  return *this;
}

std::vector<VoxelBlock::Overflow>::iterator VoxelBlock::find(std::vector<Overflow>& more, std::uint32_t key) {
  return std::lower_bound(more.begin(), more.end(), key,
                          [](const Overflow& entry, std::uint32_t wanted) { return entry.key < wanted; });
}

bool VoxelBlock::has_hits(int offset) const {
  if (!hits_) return false;
  if (hits_->count[static_cast<std::size_t>(offset)] > 0) return true;
  const auto it = find(hits_->more, key_of(offset, 0));
  return it != hits_->more.end() && it->key >> 16 == static_cast<std::uint32_t>(offset);
}

void VoxelBlock::read(int offset, VoxelCounts& counts) const {
  const auto i = static_cast<std::size_t>(offset);
  counts.passes = passes_[i];
  counts.hits.clear();
  if (!hits_) return;
  const bool has_inline = hits_->count[i] > 0;
  if (has_inline) counts.hits.push_back({hits_->label[i], hits_->count[i]});
  for (auto it = find(hits_->more, key_of(offset, 0));
       it != hits_->more.end() && it->key >> 16 == static_cast<std::uint32_t>(offset); ++it)
    counts.hits.push_back({static_cast<std::uint16_t>(it->key & 0xffffu), it->count});
  // The inline class is whichever came first; readers see classes by id.
  if (has_inline && counts.hits.size() > 1)
    std::sort(counts.hits.begin(), counts.hits.end(),
              [](const ClassCount& a, const ClassCount& b) { return a.label < b.label; });
}

void VoxelBlock::add_hit(int offset, std::uint16_t label, std::uint32_t weight) {
  if (weight == 0) return;
  if (!hits_) hits_ = std::make_unique<Hits>();
  const auto i = static_cast<std::size_t>(offset);
  if (hits_->count[i] > 0 && hits_->label[i] == label) {
    hits_->count[i] += weight;
    return;
  }
  const std::uint32_t key = key_of(offset, label);
  const auto it = find(hits_->more, key);
  if (it != hits_->more.end() && it->key == key) {
    it->count += weight;
  } else if (hits_->count[i] == 0) {
    hits_->label[i] = label;
    hits_->count[i] = weight;
  } else {
    hits_->more.insert(it, {key, weight});
  }
}

bool VoxelBlock::subtract_pass(int offset, std::uint32_t weight) {
  std::uint32_t& passes = passes_[static_cast<std::size_t>(offset)];
  if (passes < weight) return false;
  passes -= weight;
  return true;
}

bool VoxelBlock::subtract_hit(int offset, std::uint16_t label, std::uint32_t weight) {
  if (weight == 0) return true;
  if (!hits_) return false;
  const auto i = static_cast<std::size_t>(offset);
  if (hits_->count[i] > 0 && hits_->label[i] == label) {
    if (hits_->count[i] < weight) return false;
    hits_->count[i] -= weight;
    return true;
  }
  const std::uint32_t key = key_of(offset, label);
  const auto it = find(hits_->more, key);
  if (it == hits_->more.end() || it->key != key || it->count < weight) return false;
  it->count -= weight;
  if (it->count == 0) hits_->more.erase(it);
  return true;
}

bool VoxelBlock::is_empty() const {
  const auto is_zero = [](std::uint32_t n) { return n == 0; };
  if (hits_ && !(hits_->more.empty() && std::all_of(hits_->count.begin(), hits_->count.end(), is_zero))) return false;
  return std::all_of(passes_.begin(), passes_.end(), is_zero);
}

bool VoxelBlock::is_uniform() const {
  const auto is_zero = [](std::uint32_t n) { return n == 0; };
  if (hits_ && !(hits_->more.empty() && std::all_of(hits_->count.begin(), hits_->count.end(), is_zero))) return false;
  return std::all_of(passes_.begin(), passes_.end(), [this](std::uint32_t n) { return n == passes_[0]; });
}

std::size_t VoxelBlock::bytes() const {
  return sizeof(VoxelBlock) + (hits_ ? sizeof(Hits) + hits_->more.capacity() * sizeof(Overflow) : 0);
}

bool VoxelBlock::operator==(const VoxelBlock& other) const {
  if (passes_ != other.passes_) return false;
  if (!hits_ && !other.hits_) return true;
  VoxelCounts mine, theirs;  // by content: which class sits inline depends on the order of updates
  for (int offset = 0; offset < kBlockVoxels; ++offset) {
    read(offset, mine);
    other.read(offset, theirs);
    if (mine != theirs) return false;
  }
  return true;
}

}  // namespace lapis::mapping
