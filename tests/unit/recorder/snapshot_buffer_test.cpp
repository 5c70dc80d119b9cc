#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "recorder/core/snapshot_buffer.hpp"

namespace lapis::recorder {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::size_t kOften = 0, kLatched = 1;

bags::Message message(std::size_t channel, std::int64_t time_ns, std::size_t size = 10) {
  return {channel, 0, time_ns, time_ns, std::vector<std::uint8_t>(size)};
}

std::vector<std::int64_t> times(const std::vector<bags::Message>& messages) {
  std::vector<std::int64_t> found;
  for (const bags::Message& m : messages) found.push_back(m.log_time_ns);
  return found;
}

TEST(SnapshotBuffer, KeepsASpanOfTime) {
  SnapshotBuffer buffer(100, 1'000'000);
  for (std::int64_t t = 0; t <= 300; t += 50) buffer.add(message(kOften, t), false);
  EXPECT_THAT(times(buffer.take()), ElementsAre(200, 250, 300));
  EXPECT_THAT(buffer.take(), IsEmpty());
  EXPECT_EQ(buffer.bytes(), 0U);
}

TEST(SnapshotBuffer, KeepsNoMoreThanItsMemory) {
  SnapshotBuffer buffer(1'000'000, 100);
  for (std::int64_t t = 0; t < 50; ++t) {
    buffer.add(message(kOften, t, 30), false);
    EXPECT_LE(buffer.bytes(), 100U);
  }
  EXPECT_THAT(times(buffer.take()), ElementsAre(47, 48, 49));
}

TEST(SnapshotBuffer, KeepsTheLastLatchedMessageHoweverOld) {
  SnapshotBuffer buffer(100, 1'000'000);
  buffer.add(message(kLatched, 0, 1), true);
  buffer.add(message(kLatched, 1, 2), true);
  for (std::int64_t t = 500; t <= 600; t += 50) buffer.add(message(kOften, t), false);
  for (int snapshot = 0; snapshot < 2; ++snapshot) {  // of the second one, too
    const auto taken = buffer.take();
    ASSERT_EQ(taken.size(), snapshot == 0 ? 4U : 1U);
    EXPECT_EQ(taken[0].channel, kLatched);
    EXPECT_EQ(taken[0].data.size(), 2U);
    if (snapshot > 0) continue;
    EXPECT_THAT(times(taken), ElementsAre(500, 500, 550, 600));
  }
}

TEST(SnapshotBuffer, SortsByTime) {
  SnapshotBuffer buffer(100, 1'000'000);
  for (const std::int64_t t : {10, 30, 20, 40}) buffer.add(message(kOften, t), false);
  EXPECT_THAT(times(buffer.take()), ElementsAre(10, 20, 30, 40));
}

}  // namespace
}  // namespace lapis::recorder
