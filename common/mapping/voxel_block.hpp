#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/mapping/voxel_index.hpp"

namespace lapis::mapping {

/// Hits of one class in one voxel.
struct ClassCount {
  std::uint16_t label = 0;  ///< 0 = unlabelled
  std::uint32_t count = 0;  ///< [1/256 vote]
  bool operator==(const ClassCount&) const = default;
};

/// Everything a voxel knows. All zero = never observed.
struct VoxelCounts {
  std::uint32_t passes = 0;      ///< [1/256 vote]
  std::vector<ClassCount> hits;  ///< sorted by label, no zero counts

  bool is_observed() const { return passes > 0 || !hits.empty(); }
  bool operator==(const VoxelCounts&) const = default;
};

/// Counts of 8x8x8 voxels. Free space costs four bytes per voxel; the first hit in a block adds room for one class per
/// voxel (six bytes), and further classes of a voxel (object borders) go to one sorted list per block. Counts are exact
/// up to 2^32 - 1, which is 16,777,215 one-vote frames: 155 h at 30 Hz of looking at one voxel.
class VoxelBlock {
 public:
  VoxelBlock() = default;
  VoxelBlock(const VoxelBlock& other);
  VoxelBlock& operator=(const VoxelBlock& other);
  VoxelBlock(VoxelBlock&&) noexcept = default;
  VoxelBlock& operator=(VoxelBlock&&) noexcept = default;
  ~VoxelBlock() = default;

  std::uint32_t passes(int offset) const { return passes_[static_cast<std::size_t>(offset)]; }
  bool has_hits(int offset) const;
  bool is_observed(int offset) const { return passes(offset) > 0 || has_hits(offset); }
  /// Fills `counts` (its memory is reused) with the voxel's content.
  void read(int offset, VoxelCounts& counts) const;

  void add_pass(int offset, std::uint32_t weight) { passes_[static_cast<std::size_t>(offset)] += weight; }
  void add_hit(int offset, std::uint16_t label, std::uint32_t weight);
  /// False, and nothing changed, when less than `weight` is there.
  [[nodiscard]] bool subtract_pass(int offset, std::uint32_t weight);
  [[nodiscard]] bool subtract_hit(int offset, std::uint16_t label, std::uint32_t weight);

  /// True when no voxel was ever observed.
  bool is_empty() const;
  /// True when every voxel has the same passes and none has hits.
  bool is_uniform() const;
  std::size_t bytes() const;
  bool operator==(const VoxelBlock& other) const;

 private:
  struct Overflow {
    std::uint32_t key;    ///< offset << 16 | label
    std::uint32_t count;  ///< > 0
  };
  struct Hits {
    std::array<std::uint32_t, kBlockVoxels> count{};  ///< of the voxel's inline class; 0 = slot free
    std::array<std::uint16_t, kBlockVoxels> label{};
    std::vector<Overflow> more;  ///< sorted by key; never holds the inline class of its voxel
  };

  static std::uint32_t key_of(int offset, std::uint16_t label) {
    return static_cast<std::uint32_t>(offset) << 16 | label;
  }
  static std::vector<Overflow>::iterator find(std::vector<Overflow>& more, std::uint32_t key);

  std::array<std::uint32_t, kBlockVoxels> passes_{};
  std::unique_ptr<Hits> hits_;  ///< null while the block has only passes
};

}  // namespace lapis::mapping
