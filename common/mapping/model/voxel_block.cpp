#include "common/mapping/model/voxel_block.hpp"

#include <algorithm>

namespace lapis::mapping {
namespace {

/// Sort key of the hits of a block.
template <class Entry>
std::uint32_t key(const Entry& entry) {
  return static_cast<std::uint32_t>(entry.offset) << 16 | entry.label;
}

constexpr auto kByKey = [](const auto& a, const auto& b) { return key(a) < key(b); };

}  // namespace

VoxelBlock::VoxelBlock(const std::array<std::uint32_t, kBlockVoxels>& misses, std::span<const HitVote> hits)
    : misses_(misses) {
  if (hits.empty()) return;
  hits_ = std::make_unique<Hits>();
  hits_->list.reserve(hits.size());
  insert(hits);
}

VoxelBlock::VoxelBlock(const VoxelBlock& other)
    : misses_(other.misses_), hits_(other.hits_ ? std::make_unique<Hits>(*other.hits_) : nullptr) {}

VoxelBlock& VoxelBlock::operator=(const VoxelBlock& other) {
  if (this != &other) *this = VoxelBlock(other);
  return *this;
}

void VoxelBlock::read(int offset, VoxelCounts& counts) const {
  counts.misses = misses_.at(offset);
  counts.hits.clear();
  if (!has_hits(offset)) return;
  const Hit first{static_cast<std::uint16_t>(offset), 0, 0};
  auto hit = std::lower_bound(hits_->list.begin(), hits_->list.end(), first, kByKey);
  for (; hit != hits_->list.end() && hit->offset == first.offset; ++hit)
    counts.hits.push_back({hit->label, hit->count});
}

void VoxelBlock::add_hit(int offset, std::uint16_t label, std::uint32_t weight) {
  const HitVote vote{static_cast<std::uint16_t>(offset), label, weight};
  add({}, {&vote, 1});
}

void VoxelBlock::add(const BlockMask& misses, std::span<const HitVote> hits) {
  misses_.add_votes(misses);
  if (hits.empty()) return;
  if (!hits_) hits_ = std::make_unique<Hits>();
  thread_local std::vector<HitVote> fresh;
  fresh.clear();
  auto hit = hits_->list.begin();
  for (const HitVote& vote : hits) {
    if (vote.weight == 0) continue;
    while (hit != hits_->list.end() && key(*hit) < key(vote)) ++hit;
    if (hit != hits_->list.end() && key(*hit) == key(vote))
      hit->count += vote.weight;
    else
      fresh.push_back(vote);
  }
  insert(fresh);
  if (hits_->list.empty()) hits_.reset();
}

/// Merges into the list, from its end, votes for classes that their voxels do not have yet.
void VoxelBlock::insert(std::span<const HitVote> votes) {
  std::vector<Hit>& list = hits_->list;
  std::size_t from = list.size(), to = from + votes.size();
  if (to > list.capacity()) list.reserve(to + to / 4);
  list.resize(to);
  for (; !votes.empty(); votes = votes.first(votes.size() - 1)) {
    const HitVote& vote = votes.back();
    while (from > 0 && key(list[from - 1]) > key(vote)) list[--to] = list[--from];
    list[--to] = {vote.offset, vote.label, vote.weight};
    hits_->voxels[vote.offset / 64u] |= std::uint64_t{1} << vote.offset % 64u;
  }
}

bool VoxelBlock::subtract(const BlockMask& misses, std::span<const HitVote> hits) {
  if (!misses_.subtract_votes(misses)) return false;
  if (hits.empty()) return true;
  if (!hits_) return false;
  std::vector<Hit>& list = hits_->list;
  auto hit = list.begin();
  for (const HitVote& vote : hits) {
    if (vote.weight == 0) continue;
    hit = std::lower_bound(hit, list.end(), vote, kByKey);
    if (hit == list.end() || key(*hit) != key(vote) || hit->count < vote.weight) return false;
    hit->count -= vote.weight;
  }
  if (std::erase_if(list, [](const Hit& h) { return h.count == 0; }) > 0) {
    hits_->voxels = {};
    for (const Hit& h : list) hits_->voxels[h.offset / 64u] |= std::uint64_t{1} << h.offset % 64u;
  }
  if (list.empty()) hits_.reset();
  return true;
}

std::size_t VoxelBlock::bytes() const {
  const std::size_t hits = hits_ ? sizeof(Hits) + hits_->list.capacity() * sizeof(Hit) : 0;
  return sizeof(VoxelBlock) + misses_.heap_bytes() + hits;
}

bool VoxelBlock::operator==(const VoxelBlock& other) const {
  if (!(misses_ == other.misses_) || (hits_ == nullptr) != (other.hits_ == nullptr)) return false;
  return !hits_ || hits_->list == other.hits_->list;
}

}  // namespace lapis::mapping
