// Messages are written as OMG RTPS 2.3, section 9.4, lays them out.
#include "common/dds/packet_check.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "common/dds/packet_guard.hpp"

namespace lapis::dds {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put(Bytes& bytes, std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// The fields of a submessage, little endian.
class Body {
 public:
  Body& u16(std::uint64_t value) { return number(value, 2); }
  Body& u32(std::uint64_t value) { return number(value, 4); }
  Body& sequence(std::int64_t value) {
    const auto bits = static_cast<std::uint64_t>(value);
    return u32(bits >> 32U).u32(bits & 0xffffffffU);
  }
  Body& entities() { return u32(0x04010000).u32(0x03010000); }
  Body& zeros(std::size_t count) {
    bytes.resize(bytes.size() + count);
    return *this;
  }
  Bytes bytes;

 private:
  Body& number(std::uint64_t value, std::size_t size) {
    put(bytes, value, size);
    return *this;
  }
};

Bytes header(std::uint8_t vendor = 0x0f) {
  Bytes bytes{'R', 'T', 'P', 'S', 2, 3, 1, vendor};
  bytes.resize(20, 7);
  return bytes;
}

Bytes& add(Bytes& message, std::uint8_t id, std::uint8_t flags, const Body& body) {
  message.insert(message.end(), {id, static_cast<std::uint8_t>(flags | 1U)});
  put(message, body.bytes.size(), 2);
  message.insert(message.end(), body.bytes.begin(), body.bytes.end());
  return message;
}

struct BelievesEverything : SequenceJudge {
  bool believes(const Gid&, std::int64_t) override { return true; }
};

std::optional<PacketFault> find_fault(std::span<const std::uint8_t> message) {
  BelievesEverything judge;
  return dds::find_fault(message, judge);
}

std::optional<PacketFault> fault_of(std::uint8_t id, const Body& body, std::uint8_t flags = 0) {
  Bytes message = header();
  return find_fault(add(message, id, flags, body));
}

Body heartbeat(std::int64_t first, std::int64_t last) {
  return Body().entities().sequence(first).sequence(last).u32(1);
}
Body gap(std::int64_t start, std::int64_t base, std::uint32_t bits = 0) {
  return Body().entities().sequence(start).sequence(base).u32(bits).zeros((bits + 31) / 32 * 4);
}
Body acknack(std::int64_t base, std::uint32_t bits) {
  return Body().entities().sequence(base).u32(bits).zeros((bits + 31) / 32 * 4).u32(1);
}
Body nack_frag(std::int64_t sequence, std::uint32_t base, std::uint32_t bits) {
  return Body().entities().sequence(sequence).u32(base).u32(bits).zeros((bits + 31) / 32 * 4).u32(1);
}
Body data(std::uint16_t octets_to_inline_qos, std::int64_t sequence) {
  return Body().u16(0).u16(octets_to_inline_qos).entities().sequence(sequence);
}
struct Fragments {
  std::uint32_t first = 1;
  std::uint16_t count = 1;
  std::uint16_t size = 100;
  std::uint32_t sample = 250;
  std::size_t payload = 100;
};
Body data_frag(const Fragments& f) {
  return data(28, 5).u32(f.first).u16(f.count).u16(f.size).u32(f.sample).zeros(f.payload);
}

TEST(PacketCheck, RtpsOfVersionTwoOnly) {
  EXPECT_EQ(find_fault(header()), std::nullopt);
  Bytes message = header();
  message[4] = 3;
  EXPECT_EQ(find_fault(message), PacketFault::kHeader);
  message = header();
  message[0] = 'X';
  EXPECT_EQ(find_fault(message), PacketFault::kHeader);
  message = header();
  message.pop_back();
  EXPECT_EQ(find_fault(message), PacketFault::kHeader);
  EXPECT_EQ(find_fault({}), PacketFault::kHeader);
}

TEST(PacketCheck, SubmessagesEndWithinTheMessage) {
  Bytes message = header();
  add(message, 0x07, 0, heartbeat(1, 2));
  EXPECT_EQ(find_fault(message), std::nullopt);
  const Bytes whole = message;
  for (std::size_t size = whole.size() - 1; size > 20; --size) {
    EXPECT_EQ(find_fault(std::span(whole).first(size)), PacketFault::kLength) << size;
  }
  message[22] = 0;  // a length of 0: the last submessage, up to the end
  EXPECT_EQ(find_fault(message), std::nullopt);
  message.resize(30);
  EXPECT_EQ(find_fault(message), PacketFault::kLength);
}

TEST(PacketCheck, BothByteOrders) {
  Bytes message = header();
  message.insert(message.end(), {0x07, 0, 0, 28, 0, 0, 0, 0, 0, 0, 0, 0});
  message.insert(message.end(), {0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 9, 0, 0, 0, 1});
  EXPECT_EQ(find_fault(message), std::nullopt);
  message[32] = 1;  // first = 2^56 + 1
  EXPECT_EQ(find_fault(message), PacketFault::kSequence);
}

/// The datagram that ended every process: two submessages of statistics.
TEST(PacketCheck, StatisticsAreTheLastSubmessage) {
  Bytes message = header();
  add(message, 0x80, 0, Body().zeros(56));
  EXPECT_EQ(find_fault(message), std::nullopt);
  add(message, 0x80, 0, Body().zeros(56));
  EXPECT_EQ(message.size(), 140U);
  EXPECT_EQ(find_fault(message), PacketFault::kStatistics);
  message[7] = 0x10;  // another vendor's own submessages
  EXPECT_EQ(find_fault(message), std::nullopt);
  EXPECT_EQ(fault_of(0x80, Body().zeros(12)), std::nullopt);
}

TEST(PacketCheck, HeartbeatsCountFromTheFirstToTheLast) {
  EXPECT_EQ(fault_of(0x07, heartbeat(1, 0)), std::nullopt) << "nothing has been written";
  EXPECT_EQ(fault_of(0x07, heartbeat(5, 9)), std::nullopt);
  EXPECT_EQ(fault_of(0x07, heartbeat(kLargestSequence, kLargestSequence)), std::nullopt);
  for (const auto& [first, last] : {std::pair<std::int64_t, std::int64_t>{0, 5},
                                    {-1, 5},
                                    {5, 3},
                                    {1, kLargestSequence + 1},
                                    {kLargestSequence + 1, kLargestSequence + 1},
                                    {1, INT64_MAX},
                                    {1, INT64_MIN}}) {
    EXPECT_EQ(fault_of(0x07, heartbeat(first, last)), PacketFault::kSequence) << first << " " << last;
  }
}

TEST(PacketCheck, GapsAreShort) {
  EXPECT_EQ(fault_of(0x08, gap(3, 3)), std::nullopt);
  EXPECT_EQ(fault_of(0x08, gap(3, 3 + kLongestGap, 256)), std::nullopt);
  EXPECT_EQ(fault_of(0x08, gap(3, 4 + kLongestGap)), PacketFault::kGap);
  EXPECT_EQ(fault_of(0x08, gap(3, 2)), PacketFault::kSequence);
  EXPECT_EQ(fault_of(0x08, gap(0, 2)), PacketFault::kSequence);
  EXPECT_EQ(fault_of(0x08, gap(INT64_MIN, INT64_MAX)), PacketFault::kSequence);
  EXPECT_EQ(fault_of(0x08, gap(3, 3, 257)), PacketFault::kSet);
  EXPECT_EQ(fault_of(0x08, Body().entities().sequence(3).sequence(3).u32(64).zeros(4)), PacketFault::kLength);
}

TEST(PacketCheck, SetsHoldAtMost256Numbers) {
  EXPECT_EQ(fault_of(0x06, acknack(0, 0)), std::nullopt) << "a late joiner asks for everything";
  EXPECT_EQ(fault_of(0x06, acknack(7, 256)), std::nullopt);
  EXPECT_EQ(fault_of(0x06, acknack(7, 257)), PacketFault::kSet);
  EXPECT_EQ(fault_of(0x06, acknack(-7, 0)), PacketFault::kSequence);
  EXPECT_EQ(fault_of(0x12, nack_frag(7, 1, 256)), std::nullopt);
  EXPECT_EQ(fault_of(0x12, nack_frag(7, 0, 2)), PacketFault::kSet);
  EXPECT_EQ(fault_of(0x12, nack_frag(7, UINT32_MAX, 2)), PacketFault::kSet);
  EXPECT_EQ(fault_of(0x12, nack_frag(7, 1, 1000)), PacketFault::kSet);
  EXPECT_EQ(fault_of(0x12, nack_frag(0, 1, 1)), PacketFault::kSequence);
}

TEST(PacketCheck, InlineQosEndsWithinItsSubmessage) {
  constexpr std::uint8_t kInlineQos = 2;
  EXPECT_EQ(fault_of(0x15, data(16, 5)), std::nullopt);
  EXPECT_EQ(fault_of(0x15, data(20, 5).zeros(4)), std::nullopt) << "fields of a later version";
  EXPECT_EQ(fault_of(0x15, data(21, 5).zeros(4)), PacketFault::kData);
  EXPECT_EQ(fault_of(0x15, data(12, 5)), PacketFault::kData);
  EXPECT_EQ(fault_of(0x15, data(0xffff, 5)), PacketFault::kData);
  EXPECT_EQ(fault_of(0x15, data(16, 0)), PacketFault::kSequence);
  EXPECT_EQ(fault_of(0x15, data(16, 5).u16(0x70).u16(4).u32(0).u16(1).u16(0), kInlineQos), std::nullopt);
  EXPECT_EQ(fault_of(0x15, data(16, 5).u16(0x70).u16(4).u32(0), kInlineQos), PacketFault::kData) << "no end";
  EXPECT_EQ(fault_of(0x15, data(16, 5).u16(0x70).u16(99).u16(1).u16(0), kInlineQos), PacketFault::kData);
}

TEST(PacketCheck, FragmentsAreThoseOfTheSample) {
  EXPECT_EQ(fault_of(0x16, data_frag({})), std::nullopt);
  EXPECT_EQ(fault_of(0x16, data_frag({.first = 3, .payload = 50})), std::nullopt) << "the last one is shorter";
  EXPECT_EQ(fault_of(0x16, data_frag({.count = 3, .payload = 250})), std::nullopt);
  const std::vector<Fragments> faulty{{.first = 0},
                                      {.first = 4},
                                      {.first = UINT32_MAX},
                                      {.count = 0},
                                      {.count = 4, .payload = 250},
                                      {.count = 3, .payload = 249},
                                      {.first = 3, .payload = 49},
                                      {.payload = 99},
                                      {.size = 0},
                                      {.size = 3},
                                      {.sample = 0},
                                      {.sample = kLargestSample + 1},
                                      {.sample = UINT32_MAX}};
  for (std::size_t i = 0; i < faulty.size(); ++i) {
    EXPECT_EQ(fault_of(0x16, data_frag(faulty[i])), PacketFault::kFragments) << i;
  }
  constexpr std::uint8_t kKey = 4;
  EXPECT_EQ(fault_of(0x16, data_frag({}), kKey), PacketFault::kFragments);
}

TEST(PacketCheck, UnknownSubmessagesAreSkipped) {
  EXPECT_EQ(fault_of(0x33, Body().zeros(5)), std::nullopt);
  EXPECT_EQ(fault_of(0x01, Body()), std::nullopt);
  EXPECT_EQ(fault_of(0x09, Body().zeros(8)), std::nullopt);
  EXPECT_EQ(fault_of(0x09, Body(), 2), std::nullopt) << "no time";
  EXPECT_EQ(fault_of(0x0c, Body().zeros(20)), std::nullopt);
  EXPECT_EQ(fault_of(0x0c, Body().zeros(24)), PacketFault::kLength);
  EXPECT_EQ(fault_of(0x0e, Body().zeros(8)), PacketFault::kLength);
}

TEST(PacketCheck, AWriterDoesNotJump) {
  const std::vector<std::pair<std::uint8_t, std::function<Body(std::int64_t)>>> kinds{
      {0x07, [](std::int64_t n) { return heartbeat(1, n); }},
      {0x08, [](std::int64_t n) { return gap(n - 1, n); }},
      {0x15, [](std::int64_t n) { return data(16, n); }}};
  for (const auto& [id, body] : kinds) {
    WriterProgress progress;
    Bytes near = header(), far = header(), of_another = header();
    of_another[19] = 8;
    add(far, id, 0, body(1 << 28));
    EXPECT_EQ(dds::find_fault(add(near, id, 0, body(5)), progress), std::nullopt) << int(id);
    EXPECT_EQ(dds::find_fault(far, progress), PacketFault::kJump) << int(id);
    EXPECT_EQ(dds::find_fault(add(of_another, id, 0, body(1 << 28)), progress), std::nullopt) << "a new writer";
    Bytes told = header();  // INFO_SRC names the first writer's participant again
    Body source;
    source.zeros(8).bytes.resize(20, 7);
    told[19] = 8;
    add(add(told, 0x0c, 0, source), id, 0, body(1 << 28));
    EXPECT_EQ(dds::find_fault(told, progress), PacketFault::kJump) << int(id);
  }
}

TEST(WriterProgress, SilenceIsTimeToWrite) {
  WriterProgress progress;
  const Gid writer{1};
  const WriterProgress::Clock::time_point start{};
  EXPECT_TRUE(progress.believes(writer, 400'000'000, start)) << "a late joiner hears of a writer that is old";
  EXPECT_TRUE(progress.believes(writer, 7, start)) << "repeated";
  EXPECT_TRUE(progress.believes(writer, 400'000'000 + WriterProgress::kLongestJump, start));
  EXPECT_FALSE(progress.believes(writer, 400'000'001 + 2 * WriterProgress::kLongestJump, start));
  EXPECT_TRUE(
      progress.believes(writer, 400'000'001 + 2 * WriterProgress::kLongestJump, start + std::chrono::seconds(1)));
}

TEST(WriterProgress, AWriterOf1KhzIsHeardAfterWeeks) {
  constexpr std::int64_t kDay = 86'400'000;  // samples
  WriterProgress progress;
  const Gid followed{1}, old{2}, impossible{3};
  const WriterProgress::Clock::time_point start{};
  for (int day = 0; day < 60; ++day) {
    EXPECT_TRUE(progress.believes(followed, 1 + day * kDay, start + std::chrono::hours(24 * day))) << day;
  }
  EXPECT_TRUE(progress.believes(old, 40 * kDay, start)) << "by a reader that joins";
  EXPECT_FALSE(progress.believes(impossible, WriterProgress::kLargestFirst + 1, start));
  EXPECT_TRUE(progress.believes(impossible, 1, start)) << "what is not believed is not remembered";
}

compat::rtps::Locator_t from(const std::string& address) {
  compat::rtps::Locator_t locator;
  compat::IPLocator::setIPv4(locator, address);
  return locator;
}

TEST(PacketGuard, CountsByReasonAndNamesTheSender) {
  PacketGuard guard{{}};
  const Bytes good = header();
  EXPECT_TRUE(guard.admits(good, from("10.1.2.3"), false));
  EXPECT_FALSE(guard.admits(Bytes{1, 2, 3}, from("10.1.2.3"), false));
  EXPECT_FALSE(guard.admits(Bytes{1, 2, 3}, from("10.1.2.4"), true));
  EXPECT_EQ(guard.dropped(PacketFault::kHeader).count, 2U);
  EXPECT_EQ(guard.dropped(PacketFault::kHeader).newest_sender, "10.1.2.4");
  EXPECT_EQ(guard.dropped(PacketFault::kSender).count, 0U);
}

TEST(PacketGuard, StaticPeersAndAllowedPeersMaySend) {
  DiscoverySettings settings;
  settings.allowed_peers = {{0x0a010000, 0xffff0000}};
  settings.static_peers = {"192.168.1.7"};
  PacketGuard guard(settings);
  const Bytes good = header();
  EXPECT_TRUE(guard.admits(good, from("10.1.200.3"), false));
  EXPECT_TRUE(guard.admits(good, from("192.168.1.7"), false));
  EXPECT_FALSE(guard.admits(good, from("10.2.200.3"), false));
  EXPECT_TRUE(guard.admits(good, from("10.2.200.3"), true)) << "an address of this host";
  EXPECT_EQ(guard.dropped(PacketFault::kSender).newest_sender, "10.2.200.3");
}

TEST(PacketGuard, LocalhostIsTheOwnHost) {
  DiscoverySettings settings;
  settings.range = DiscoveryRange::kLocalhost;
  PacketGuard guard(settings);
  EXPECT_TRUE(guard.admits(header(), from("127.0.0.1"), true));
  EXPECT_FALSE(guard.admits(header(), from("10.2.200.3"), false));
}

}  // namespace
}  // namespace lapis::dds
