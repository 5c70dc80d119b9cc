#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <variant>

#include "common/mapping/model/frame_votes.hpp"

namespace lapis::mapping {

/// Misses of the 512 voxels of a block [1/256 vote], in as few bytes as they need: one number while all voxels have the
/// same count, then one byte of whole votes per voxel, then two, then four bytes of 1/256 votes. Exact in each form.
class MissCounts {
 public:
  MissCounts() = default;
  /// The same count for every voxel [1/256 vote].
  explicit MissCounts(std::uint32_t all) : counts_(all) {}
  /// One count per voxel [1/256 vote], indexed by offset_in_block.
  explicit MissCounts(const std::array<std::uint32_t, kBlockVoxels>& counts);
  MissCounts(const MissCounts& other);
  MissCounts& operator=(const MissCounts& other);
  MissCounts(MissCounts&&) noexcept = default;
  MissCounts& operator=(MissCounts&&) noexcept = default;
  ~MissCounts() = default;

  std::uint32_t at(int offset) const;
  void add(int offset, std::uint32_t weight);
  /// Returns false, and changes nothing, when the count is less than `weight`.
  [[nodiscard]] bool subtract(int offset, std::uint32_t weight);
  /// Adds one vote to each voxel of the mask.
  void add_votes(const BlockMask& voxels);
  /// Subtracts one vote from each voxel of the mask. Returns false, and leaves the counts unspecified, when one of
  /// these voxels has less than one vote.
  [[nodiscard]] bool subtract_votes(const BlockMask& voxels);

  bool is_uniform() const;
  /// Memory beyond this object [bytes].
  std::size_t heap_bytes() const;
  /// True for equal counts, whatever their form.
  bool operator==(const MissCounts& other) const;

 private:
  template <class Count>
  using PerVoxel = std::unique_ptr<std::array<Count, kBlockVoxels>>;
  using Bytes = PerVoxel<std::uint8_t>;   ///< [vote]
  using Words = PerVoxel<std::uint16_t>;  ///< [vote]
  using Parts = PerVoxel<std::uint32_t>;  ///< [1/256 vote]

  template <class Form>
  void widen();
  void make_room_for(std::uint32_t count);
  void make_room_for_one_more_vote();

  std::variant<std::uint32_t, Bytes, Words, Parts> counts_ = 0u;
};

}  // namespace lapis::mapping
