#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "common/dds/gid.hpp"

namespace lapis::dds {

/// Why a datagram does not reach Fast DDS.
enum class PacketFault {
  kSender,      ///< not one of the addresses that are allowed
  kHeader,      ///< not an RTPS message of version 2
  kLength,      ///< a submessage is longer than the message, or shorter than its fields
  kStatistics,  ///< a submessage of Fast DDS's statistics that is not the last one
  kData,        ///< inline QoS that does not end within its submessage
  kFragments,   ///< fragments that are not those of a sample, or not there
  kSequence,    ///< a sequence number below 1 or above kLargestSequence, or a range that ends before it begins
  kJump,        ///< a sequence number far beyond those that the writer has used before
  kGap,         ///< more than kLongestGap numbers at once
  kSet          ///< a set of numbers that is larger than 256
};
inline constexpr std::size_t kPacketFaults = 10;
inline constexpr std::array<const char*, kPacketFaults> kPacketFaultNames{
    "sender", "header", "length", "statistics", "data", "fragments", "sequence", "jump", "gap", "set"};

/// Beyond what any writer reaches, and far from where sums overflow. How far a certain writer can have come is for the
/// SequenceJudge to say: Fast DDS counts from the last number that a reader knows to a new one, one by one (0.1 us
/// each) and with the reader locked.
inline constexpr std::int64_t kLargestSequence = std::int64_t{1} << 48;
/// It also keeps the numbers of a gap one by one. A late joiner of a keyed topic is told of all samples that later ones
/// of the same key have replaced: 80 tiles per second for 14 hours.
inline constexpr std::int64_t kLongestGap = std::int64_t{1} << 22;
/// It allocates a sample when the first of its fragments arrives.
inline constexpr std::uint32_t kLargestSample = 128U << 20U;

/// Decides whether a writer can have come as far as a sequence number.
class SequenceJudge {
 public:
  virtual ~SequenceJudge() = default;
  virtual bool believes(const Gid& writer, std::int64_t number) = 0;
};

/// Checks an RTPS message before Fast DDS 2.9 reads it, which ends the process, reads past the message or counts for
/// ever when certain fields are wrong. What is checked, and why: docs/decisions/0056-packet-guard.md. Nothing is said
/// about a message that is well formed and lies.
/// @return nothing when the message may pass; layout: OMG RTPS 2.3, section 9.4
std::optional<PacketFault> find_fault(std::span<const std::uint8_t> message, SequenceJudge& judge);

}  // namespace lapis::dds
