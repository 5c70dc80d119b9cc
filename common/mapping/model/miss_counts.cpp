#include "common/mapping/model/miss_counts.hpp"

#include <algorithm>
#include <type_traits>

namespace lapis::mapping {
namespace {

/// Number of 1/256 votes that one count of an array stands for.
template <class Count>
constexpr std::uint32_t kUnit = sizeof(Count) == 4 ? 1 : kOneVote;

constexpr std::array<std::array<std::uint8_t, 8>, 256> kBitsOfByte = [] {
  std::array<std::array<std::uint8_t, 8>, 256> bits{};
  for (std::size_t byte = 0; byte < 256; ++byte)
    for (std::size_t i = 0; i < 8; ++i) bits[byte][i] = byte >> i & 1u;
  return bits;
}();

/// Calls use(first voxel, bits of eight voxels as bytes) for each byte of the mask that is not zero.
template <class Use>
void for_each_byte(const BlockMask& voxels, Use&& use) {
  for (std::size_t first = 0; first < kBlockVoxels; first += 8) {
    const std::size_t byte = voxels[first / 64] >> first % 64 & 0xffu;
    if (byte != 0) use(first, kBitsOfByte[byte]);
  }
}

template <class Count>
void add_votes_to(std::array<Count, kBlockVoxels>& counts, const BlockMask& voxels) {
  constexpr auto kVote = static_cast<Count>(kOneVote / kUnit<Count>);
  for_each_byte(voxels, [&counts](std::size_t first, const std::array<std::uint8_t, 8>& bits) {
    for (std::size_t i = 0; i < 8; ++i) counts[first + i] = static_cast<Count>(counts[first + i] + bits[i] * kVote);
  });
}

template <class Count>
bool subtract_votes_from(std::array<Count, kBlockVoxels>& counts, const BlockMask& voxels) {
  constexpr auto kVote = static_cast<Count>(kOneVote / kUnit<Count>);
  bool were_there = true;
  for_each_byte(voxels, [&](std::size_t first, const std::array<std::uint8_t, 8>& bits) {
    for (std::size_t i = 0; i < 8; ++i) {
      const auto part = static_cast<Count>(bits[i] * kVote);
      were_there &= counts[first + i] >= part;
      counts[first + i] = static_cast<Count>(counts[first + i] - part);
    }
  });
  return were_there;
}

bool is_full(const BlockMask& voxels) {
  return std::all_of(voxels.begin(), voxels.end(), [](std::uint64_t word) { return word == ~std::uint64_t{0}; });
}

bool is_none(const BlockMask& voxels) {
  return std::all_of(voxels.begin(), voxels.end(), [](std::uint64_t word) { return word == 0; });
}

}  // namespace

MissCounts::MissCounts(const std::array<std::uint32_t, kBlockVoxels>& counts) {
  std::uint32_t largest = 0, bits = 0, differences = 0;
  for (const std::uint32_t count : counts) {
    largest = std::max(largest, count);
    bits |= count;
    differences |= count ^ counts[0];
  }
  counts_ = counts[0];
  if (differences == 0) return;
  make_room_for(bits % kOneVote == 0 ? largest : 1);
  std::visit(
      [&counts](auto& form) {
        if constexpr (!std::is_same_v<std::decay_t<decltype(form)>, std::uint32_t>) {
          using Count = typename std::decay_t<decltype(*form)>::value_type;
          for (std::size_t i = 0; i < kBlockVoxels; ++i) (*form)[i] = static_cast<Count>(counts[i] / kUnit<Count>);
        }
      },
      counts_);
}

MissCounts::MissCounts(const MissCounts& other) {
  std::visit(
      [this](const auto& counts) {
        using Form = std::decay_t<decltype(counts)>;
        if constexpr (std::is_same_v<Form, std::uint32_t>)
          counts_ = counts;
        else
          counts_ = std::make_unique<typename Form::element_type>(*counts);
      },
      other.counts_);
}

MissCounts& MissCounts::operator=(const MissCounts& other) {
  if (this != &other) *this = MissCounts(other);
  return *this;
}

std::uint32_t MissCounts::at(int offset) const {
  const auto i = static_cast<std::size_t>(offset);
  if (const auto* bytes = std::get_if<Bytes>(&counts_)) return (**bytes)[i] * kOneVote;
  if (const auto* words = std::get_if<Words>(&counts_)) return (**words)[i] * kOneVote;
  if (const auto* parts = std::get_if<Parts>(&counts_)) return (**parts)[i];
  return std::get<std::uint32_t>(counts_);
}

template <class Form>
void MissCounts::widen() {
  using Count = typename Form::element_type::value_type;
  auto wide = std::make_unique<typename Form::element_type>();
  for (int offset = 0; offset < kBlockVoxels; ++offset)
    (*wide)[static_cast<std::size_t>(offset)] = static_cast<Count>(at(offset) / kUnit<Count>);
  counts_ = std::move(wide);
}

/// Switches to one count per voxel that is wide enough for the present counts and for `count` [1/256 vote].
void MissCounts::make_room_for(std::uint32_t count) {
  const auto* all = std::get_if<std::uint32_t>(&counts_);
  const std::uint32_t largest = all ? std::max(*all, count) : count;
  if (count % kOneVote != 0 || (all && *all % kOneVote != 0) || largest > 0xffff * kOneVote) {
    if (!std::holds_alternative<Parts>(counts_)) widen<Parts>();
  } else if (largest > 0xff * kOneVote) {
    if (counts_.index() < 2) widen<Words>();
  } else if (all) {
    widen<Bytes>();
  }
}

void MissCounts::make_room_for_one_more_vote() {
  std::uint32_t largest = 0;
  if (const auto* bytes = std::get_if<Bytes>(&counts_)) {
    std::uint8_t most = 0;
    for (const std::uint8_t count : **bytes) most = std::max(most, count);
    largest = most * kOneVote;
  } else if (const auto* words = std::get_if<Words>(&counts_)) {
    std::uint16_t most = 0;
    for (const std::uint16_t count : **words) most = std::max(most, count);
    largest = most * kOneVote;
  } else if (const auto* all = std::get_if<std::uint32_t>(&counts_)) {
    largest = *all;
  }
  make_room_for(largest + kOneVote);
}

void MissCounts::add(int offset, std::uint32_t weight) {
  if (weight == 0) return;
  const std::uint32_t sum = at(offset) + weight;
  make_room_for(sum);
  const auto i = static_cast<std::size_t>(offset);
  if (auto* bytes = std::get_if<Bytes>(&counts_))
    (**bytes)[i] = static_cast<std::uint8_t>(sum / kOneVote);
  else if (auto* words = std::get_if<Words>(&counts_))
    (**words)[i] = static_cast<std::uint16_t>(sum / kOneVote);
  else
    (*std::get<Parts>(counts_))[i] = sum;
}

bool MissCounts::subtract(int offset, std::uint32_t weight) {
  const std::uint32_t before = at(offset);
  if (before < weight) return false;
  const auto i = static_cast<std::size_t>(offset);
  make_room_for(before - weight);
  if (auto* bytes = std::get_if<Bytes>(&counts_))
    (**bytes)[i] = static_cast<std::uint8_t>((before - weight) / kOneVote);
  else if (auto* words = std::get_if<Words>(&counts_))
    (**words)[i] = static_cast<std::uint16_t>((before - weight) / kOneVote);
  else
    (*std::get<Parts>(counts_))[i] = before - weight;
  return true;
}

void MissCounts::add_votes(const BlockMask& voxels) {
  if (auto* all = std::get_if<std::uint32_t>(&counts_); all && is_full(voxels)) {
    *all += kOneVote;
    return;
  }
  if (is_none(voxels)) return;
  make_room_for_one_more_vote();
  if (auto* bytes = std::get_if<Bytes>(&counts_))
    add_votes_to(**bytes, voxels);
  else if (auto* words = std::get_if<Words>(&counts_))
    add_votes_to(**words, voxels);
  else
    add_votes_to(*std::get<Parts>(counts_), voxels);
}

bool MissCounts::subtract_votes(const BlockMask& voxels) {
  if (is_none(voxels)) return true;
  if (auto* all = std::get_if<std::uint32_t>(&counts_)) {
    if (*all < kOneVote) return false;
    if (is_full(voxels)) {
      *all -= kOneVote;
      return true;
    }
    make_room_for(*all);
  }
  if (auto* bytes = std::get_if<Bytes>(&counts_)) return subtract_votes_from(**bytes, voxels);
  if (auto* words = std::get_if<Words>(&counts_)) return subtract_votes_from(**words, voxels);
  return subtract_votes_from(*std::get<Parts>(counts_), voxels);
}

bool MissCounts::is_uniform() const {
  const std::uint32_t first = at(0);
  int offset = 1;
  while (offset < kBlockVoxels && at(offset) == first) ++offset;
  return offset == kBlockVoxels;
}

std::size_t MissCounts::heap_bytes() const {
  constexpr std::array<std::size_t, 4> kBytesPerVoxel = {0, 1, 2, 4};
  return kBytesPerVoxel[counts_.index()] * kBlockVoxels;
}

bool MissCounts::operator==(const MissCounts& other) const {
  int offset = 0;
  while (offset < kBlockVoxels && at(offset) == other.at(offset)) ++offset;
  return offset == kBlockVoxels;
}

}  // namespace lapis::mapping
