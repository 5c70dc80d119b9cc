#include "semantic_mapper/core/map_stakes.hpp"

#include <algorithm>
#include <bit>
#include <stdexcept>
#include <utility>

namespace lapis::semantic_mapper {
namespace {

template <class Part>
auto find_part(std::vector<Part>& parts, std::uint64_t keyframe, std::uint32_t bin) {
  return std::lower_bound(
      parts.begin(), parts.end(), std::pair(keyframe, bin),
      [](const Part& part, const auto& wanted) { return std::pair(part.keyframe, part.bin) < wanted; });
}

}  // namespace

/// Calls change_part(parts, bin, weight) for every hit.
template <class Change>
void MapStakes::change(const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes,
                       const Change& change_part) {
  for (const mapping::BlockVotes& block : votes.blocks) {
    for (const mapping::HitVote& hit : votes.hits_of(block)) {
      const mapping::VoxelIndex voxel = mapping::voxel_at(block.block, hit.offset);
      const Eigen::Vector3d p_map = resolution_m_ * (Eigen::Vector3d(voxel.x, voxel.y, voxel.z).array() + 0.5);
      Surface& surface = surfaces_[voxel];
      if (surface.is_counted) count(surface, false);
      change_part(surface.parts, static_cast<std::uint32_t>((p_map - p_map_keyframe).norm() / kStakeBin_m), hit.weight);
      known_[block.block][hit.offset / 64U] |= std::uint64_t{1} << hit.offset % 64U;
      touched_.push_back(voxel);
    }
    touch_missed(block);
  }
}

void MapStakes::add(std::uint64_t keyframe, const Eigen::Vector3d& p_map_keyframe, const mapping::FrameVotes& votes) {
  change(p_map_keyframe, votes, [keyframe](std::vector<Part>& parts, std::uint32_t bin, std::uint32_t weight) {
    const auto part = find_part(parts, keyframe, bin);
    if (part != parts.end() && part->keyframe == keyframe && part->bin == bin) {
      part->weight += weight;
    } else {
      parts.insert(part, {keyframe, bin, weight});
    }
  });
}

void MapStakes::subtract(std::uint64_t keyframe, const Eigen::Vector3d& p_map_keyframe,
                         const mapping::FrameVotes& votes) {
  change(p_map_keyframe, votes, [keyframe](std::vector<Part>& parts, std::uint32_t bin, std::uint32_t weight) {
    const auto part = find_part(parts, keyframe, bin);
    if (part == parts.end() || part->keyframe != keyframe || part->bin != bin || part->weight < weight)
      throw std::logic_error("votes that never came into the map are taken out of its stakes");
    part->weight -= weight;
    if (part->weight == 0) parts.erase(part);
  });
}

/// Voxels with a miss may be free by now.
void MapStakes::touch_missed(const mapping::BlockVotes& votes) {
  const auto known = known_.find(votes.block);
  if (known == known_.end()) return;
  for (std::size_t word = 0; word < votes.misses.size(); ++word) {
    for (std::uint64_t bits = votes.misses[word] & known->second[word]; bits != 0; bits &= bits - 1)
      touched_.push_back(mapping::voxel_at(votes.block, static_cast<int>(word) * 64 + std::countr_zero(bits)));
  }
}

/// The parts are rounded so that their sum is exactly one voxel.
void MapStakes::count(Surface& surface, bool is_counted) {
  surface.is_counted = is_counted;
  std::int64_t whole = 0, before = 0, sum = 0;
  for (const Part& part : surface.parts) whole += part.weight;
  for (const Part& part : surface.parts) {
    sum += part.weight;
    const std::int64_t up_to = kOneVoxel * sum / whole;
    const auto known = stakes_.try_emplace(part.keyframe).first;
    Stake& stake = known->second;
    if (stake.size() <= part.bin) stake.resize(part.bin + std::size_t{1});
    stake[part.bin] += is_counted ? up_to - before : before - up_to;
    while (!stake.empty() && stake.back() == 0) stake.pop_back();
    if (stake.empty()) stakes_.erase(known);
    before = up_to;
  }
}

void MapStakes::update(const mapping::VoxelMap& map) {
  for (const mapping::VoxelIndex& voxel : touched_) {
    const auto found = surfaces_.find(voxel);
    if (found == surfaces_.end()) continue;
    if (found->second.parts.empty()) {
      const auto offset = static_cast<unsigned>(mapping::offset_in_block(voxel));
      known_[mapping::block_of(voxel)][offset / 64U] &= ~(std::uint64_t{1} << offset % 64U);
      surfaces_.erase(found);
      continue;
    }
    const bool is_occupied = reader_.is_occupied(map.read(voxel));
    if (is_occupied != found->second.is_counted) count(found->second, is_occupied);
  }
  touched_.clear();
}

}  // namespace lapis::semantic_mapper
