#include "common/dds/packet_check.hpp"

#include <algorithm>
#include <cstring>

namespace lapis::dds {
namespace {

using Fault = std::optional<PacketFault>;
using Bytes = std::span<const std::uint8_t>;

constexpr Fault kFine = std::nullopt;
constexpr std::size_t kHeaderBytes = 20;
constexpr std::size_t kSubmessageHeaderBytes = 4;
constexpr std::size_t kEntitiesBytes = 8;  // reader and writer
constexpr std::size_t kStatisticsBytes = 56;
constexpr std::array<std::uint8_t, 2> kEprosima{0x01, 0x0f};

enum Submessage : std::uint8_t {
  kPad = 0x01,
  kAckNack = 0x06,
  kHeartbeat = 0x07,
  kGap = 0x08,
  kInfoTimestamp = 0x09,
  kInfoSource = 0x0c,
  kInfoDestination = 0x0e,
  kNackFrag = 0x12,
  kHeartbeatFrag = 0x13,
  kData = 0x15,
  kDataFrag = 0x16,
  kStatistics = 0x80  // of vendor eProsima
};

/// Fields of a submessage in its own byte order. Reading past the end gives zeros and is remembered.
class Fields {
 public:
  Fields(Bytes bytes, bool is_little_endian) : bytes_(bytes), is_little_endian_(is_little_endian) {}

  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::int64_t sequence() {
    const std::uint64_t high = u32();
    return static_cast<std::int64_t>((high << 32U) | u32());
  }
  Bytes take(std::size_t count) {
    const Bytes from = bytes_;
    skip(count);
    return is_short_ ? Bytes{} : from.first(count);
  }
  void skip(std::size_t count) {
    is_short_ = is_short_ || count > bytes_.size();
    bytes_ = bytes_.subspan(is_short_ ? bytes_.size() : count);
  }
  std::size_t left() const { return bytes_.size(); }
  bool is_short() const { return is_short_; }

 private:
  std::uint64_t number(std::size_t size) {
    const Bytes from = bytes_;
    skip(size);
    if (is_short_) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = (value << 8U) | from[is_little_endian_ ? size - 1 - i : i];
    return value;
  }

  Bytes bytes_;
  bool is_little_endian_;
  bool is_short_ = false;
};

/// What has been read of a message that later submessages refer to.
struct MessageSource {
  Gid writer{};  // the entity id is that of the last submessage
  SequenceJudge& judge;

  void set_prefix(Bytes prefix) { std::copy(prefix.begin(), prefix.end(), writer.begin()); }
  /// Reads the ids of reader and writer.
  void read_writer(Fields& fields) {
    fields.skip(4);
    const Bytes id = fields.take(4);
    std::copy(id.begin(), id.end(), writer.begin() + kGidPrefixBytes);
  }
  Fault check(std::int64_t number) { return judge.believes(writer, number) ? kFine : PacketFault::kJump; }
};

bool is_sequence(std::int64_t number) { return number >= 1 && number <= kLargestSequence; }

/// Reads the size and the bits of a set; its base has been read.
Fault check_set(Fields& fields) {
  const std::uint32_t bits = fields.u32();
  if (bits > 256) return PacketFault::kSet;
  fields.skip((bits + 31) / 32 * 4);
  return fields.is_short() ? PacketFault::kLength : kFine;
}

Fault check_heartbeat(Fields fields, MessageSource& source) {
  source.read_writer(fields);
  const std::int64_t first = fields.sequence();
  const std::int64_t last = fields.sequence();
  fields.skip(4);  // count
  if (fields.is_short()) return PacketFault::kLength;
  const bool is_range = is_sequence(first) && last >= first - 1 && last <= kLargestSequence;
  return is_range ? source.check(last) : PacketFault::kSequence;
}

Fault check_gap(Fields fields, MessageSource& source) {
  source.read_writer(fields);
  const std::int64_t start = fields.sequence();
  const std::int64_t base = fields.sequence();
  if (const Fault fault = check_set(fields)) return fault;
  if (!is_sequence(start) || !is_sequence(base) || base < start) return PacketFault::kSequence;
  return base - start <= kLongestGap ? source.check(base) : PacketFault::kGap;
}

/// A base of 0 asks for everything.
Fault check_acknack(Fields fields) {
  fields.skip(kEntitiesBytes);
  const std::int64_t base = fields.sequence();
  if (const Fault fault = check_set(fields)) return fault;
  fields.skip(4);  // count
  if (fields.is_short()) return PacketFault::kLength;
  return base == 0 || is_sequence(base) ? kFine : PacketFault::kSequence;
}

Fault check_nack_frag(Fields fields) {
  fields.skip(kEntitiesBytes);
  const std::int64_t sequence = fields.sequence();
  const std::uint32_t base = fields.u32();
  if (const Fault fault = check_set(fields)) return fault;
  fields.skip(4);  // count
  if (fields.is_short()) return PacketFault::kLength;
  if (!is_sequence(sequence)) return PacketFault::kSequence;
  return base >= 1 && base <= kLargestSample ? kFine : PacketFault::kSet;
}

/// Goes to the payload: past what later versions may have put before the inline QoS, and past the inline QoS.
/// @param known bytes from the count of octets to the place where version 2.3 has the inline QoS
Fault skip_to_payload(Fields& fields, std::uint16_t octets_to_inline_qos, std::size_t known, bool has_inline_qos) {
  constexpr std::uint16_t kSentinel = 1;
  if (octets_to_inline_qos < known) return PacketFault::kData;
  fields.skip(octets_to_inline_qos - known);
  while (has_inline_qos && !fields.is_short()) {
    const std::uint16_t parameter = fields.u16();
    const std::uint16_t length = fields.u16();
    if (parameter == kSentinel) break;
    fields.skip(length);
  }
  return fields.is_short() ? PacketFault::kData : kFine;
}

Fault check_data(Fields fields, std::uint8_t flags, MessageSource& source) {
  fields.skip(2);  // extra flags
  const std::uint16_t octets_to_inline_qos = fields.u16();
  source.read_writer(fields);
  const std::int64_t sequence = fields.sequence();
  if (fields.is_short()) return PacketFault::kLength;
  if (!is_sequence(sequence)) return PacketFault::kSequence;
  const Fault fault = skip_to_payload(fields, octets_to_inline_qos, 16, (flags & 2U) != 0);
  return fault ? fault : source.check(sequence);
}

Fault check_data_frag(Fields fields, std::uint8_t flags, MessageSource& source) {
  fields.skip(2);  // extra flags
  const std::uint16_t octets_to_inline_qos = fields.u16();
  source.read_writer(fields);
  const std::int64_t sequence = fields.sequence();
  const std::uint64_t first = fields.u32();
  const std::uint64_t count = fields.u16();
  const std::uint64_t size = fields.u16();
  const std::uint64_t sample = fields.u32();
  if (fields.is_short()) return PacketFault::kLength;
  if (!is_sequence(sequence)) return PacketFault::kSequence;
  if (const Fault fault = skip_to_payload(fields, octets_to_inline_qos, 28, (flags & 2U) != 0)) return fault;
  // Fast DDS keeps a list of the missing fragments in their own places, four bytes in each, and takes a fragmented key
  // for a fragment without bytes.
  const bool has_key = (flags & 4U) != 0;
  if (has_key || size < 4 || first < 1 || count < 1 || sample > kLargestSample) return PacketFault::kFragments;
  const std::uint64_t begin = (first - 1) * size;
  if (begin + (count - 1) * size >= sample) return PacketFault::kFragments;
  const std::uint64_t expected = std::min(count * size, sample - begin);
  return fields.left() >= expected ? source.check(sequence) : PacketFault::kFragments;
}

/// @param left bytes of the message after this submessage
Fault check_submessage(std::uint8_t id, std::uint8_t flags, Bytes body, std::size_t left, bool is_of_eprosima,
                       MessageSource& source) {
  const Fields fields(body, (flags & 1U) != 0);
  const auto at_least = [&](std::size_t size) { return body.size() >= size ? kFine : PacketFault::kLength; };
  switch (id) {
    case kAckNack: return check_acknack(fields);
    case kHeartbeat: return check_heartbeat(fields, source);
    case kGap: return check_gap(fields, source);
    case kInfoTimestamp: return at_least((flags & 2U) != 0 ? 0 : 8);
    case kInfoSource:
      if (body.size() != 20) return PacketFault::kLength;
      source.set_prefix(body.last(kGidPrefixBytes));
      return kFine;
    case kInfoDestination: return at_least(12);
    case kNackFrag: return check_nack_frag(fields);
    case kHeartbeatFrag: return at_least(24);
    case kData: return check_data(fields, flags, source);
    case kDataFrag: return check_data_frag(fields, flags, source);
    case kStatistics:
      // Fast DDS asserts that one of this size is the last one, and skips others.
      return is_of_eprosima && body.size() == kStatisticsBytes && left > 0 ? Fault(PacketFault::kStatistics) : kFine;
    default: return kFine;  // Fast DDS skips it
  }
}

}  // namespace

Fault find_fault(Bytes message, SequenceJudge& judge) {
  constexpr std::uint8_t kVersion = 2;
  if (message.size() < kHeaderBytes || std::memcmp(message.data(), "RTPS", 4) != 0 || message[4] != kVersion) {
    return PacketFault::kHeader;
  }
  const bool is_of_eprosima = std::equal(kEprosima.begin(), kEprosima.end(), &message[6]);
  MessageSource source{.judge = judge};
  source.set_prefix(message.subspan(8, kGidPrefixBytes));
  Bytes rest = message.subspan(kHeaderBytes);
  while (!rest.empty()) {
    if (rest.size() < kSubmessageHeaderBytes) return PacketFault::kLength;
    const std::uint8_t id = rest[0];
    const std::uint8_t flags = rest[1];
    std::size_t length = Fields(rest.subspan(2, 2), (flags & 1U) != 0).u16();
    rest = rest.subspan(kSubmessageHeaderBytes);
    if (length > rest.size()) return PacketFault::kLength;
    if (length == 0 && id != kPad && id != kInfoTimestamp) length = rest.size();  // the last one
    const Bytes body = rest.first(length);
    // Fast DDS looks for the next one at a multiple of four bytes.
    rest = rest.subspan(std::min((length + 3) / 4 * 4, rest.size()));
    if (const Fault fault = check_submessage(id, flags, body, rest.size(), is_of_eprosima, source)) return fault;
  }
  return kFine;
}

}  // namespace lapis::dds
