#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/model/miss_counts.hpp"

namespace lapis::mapping {

/// Hits of one class in one voxel.
struct ClassCount {
  std::uint16_t label = 0;  ///< 0 = unlabelled
  std::uint32_t count = 0;  ///< [1/256 vote]
  bool operator==(const ClassCount&) const = default;
};

/// All counts of a voxel. All zero = never observed.
struct VoxelCounts {
  std::uint32_t misses = 0;      ///< [1/256 vote]
  std::vector<ClassCount> hits;  ///< sorted by label, no zero counts

  bool is_observed() const { return misses > 0 || !hits.empty(); }
  bool operator==(const VoxelCounts&) const = default;
};

/// Counts of 8x8x8 voxels. Misses take as few bytes as they need (MissCounts); hits take eight bytes per voxel and
/// class seen there, plus one bit per voxel. Counts are exact up to 2^32 - 1, which is 16,777,215 one-vote frames: 155
/// h of observing one voxel at 30 Hz.
class VoxelBlock {
 public:
  VoxelBlock() = default;
  /// Every voxel has the same misses and none has hits.
  explicit VoxelBlock(std::uint32_t misses) : misses_(misses) {}
  /// All counts at once: misses by offset [1/256 vote], and hits sorted by offset, then label, none of them zero.
  VoxelBlock(const std::array<std::uint32_t, kBlockVoxels>& misses, std::span<const HitVote> hits);
  VoxelBlock(const VoxelBlock& other);
  VoxelBlock& operator=(const VoxelBlock& other);
  VoxelBlock(VoxelBlock&&) noexcept = default;
  VoxelBlock& operator=(VoxelBlock&&) noexcept = default;
  ~VoxelBlock() = default;

  std::uint32_t misses(int offset) const { return misses_.at(offset); }
  bool has_hits(int offset) const {
    return hits_ && (hits_->voxels[static_cast<std::size_t>(offset) / 64] >> offset % 64 & 1u) != 0;
  }
  bool is_observed(int offset) const { return misses(offset) > 0 || has_hits(offset); }
  /// Fills `counts` (its memory is reused) with the voxel's content.
  void read(int offset, VoxelCounts& counts) const;

  void add_miss(int offset, std::uint32_t weight) { misses_.add(offset, weight); }
  void add_hit(int offset, std::uint16_t label, std::uint32_t weight);
  /// Adds the votes of one frame: hits sorted by offset, then label, without duplicate pairs.
  void add(const BlockMask& misses, std::span<const HitVote> hits);
  /// Inverse of add. Returns false, and leaves the block unspecified, when the votes were never added.
  [[nodiscard]] bool subtract(const BlockMask& misses, std::span<const HitVote> hits);

  /// True when no voxel was ever observed.
  bool is_empty() const { return is_uniform() && misses(0) == 0; }
  /// True when every voxel has the same misses and none has hits.
  bool is_uniform() const { return !hits_ && misses_.is_uniform(); }
  std::size_t bytes() const;
  bool operator==(const VoxelBlock& other) const;

 private:
  struct Hit {
    std::uint16_t offset;
    std::uint16_t label;
    std::uint32_t count;  ///< [1/256 vote], > 0
    bool operator==(const Hit&) const = default;
  };
  struct Hits {
    BlockMask voxels{};     ///< voxels that have hits
    std::vector<Hit> list;  ///< sorted by offset, then label
  };

  void insert(std::span<const HitVote> votes);

  MissCounts misses_;
  std::unique_ptr<Hits> hits_;  ///< null when the block has no hits
};

}  // namespace lapis::mapping
