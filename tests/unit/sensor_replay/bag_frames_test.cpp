// Messages of a bag become frames by their stamps, in whatever order topics were recorded.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "common/bags/leading_stamp.hpp"
#include "sensor_replay/core/bag_frames.hpp"

namespace lapis::sensor_replay {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr std::size_t kColorChannel = 0, kDepthChannel = 1, kOdometryChannel = 2, kStrangeChannel = 3;

std::vector<std::uint8_t> cdr(std::int64_t stamp_ms) {
  const auto seconds = static_cast<std::uint32_t>(stamp_ms / 1000);
  const auto nanoseconds = static_cast<std::uint32_t>(stamp_ms % 1000 * 1'000'000);
  std::vector<std::uint8_t> bytes{0, 1, 0, 0};
  for (const std::uint32_t number : {seconds, nanoseconds}) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<std::uint8_t>(number >> shift));
  }
  return bytes;
}

bags::Message message(std::size_t channel, std::int64_t stamp_ms, std::int64_t log_ms) {
  return {channel, 0, 1'000'000 * log_ms, 1'000'000 * log_ms, cdr(stamp_ms)};
}

/// A bag in memory.
class Messages : public bags::StorageReader {
 public:
  explicit Messages(std::vector<bags::Message> messages) : messages_(std::move(messages)) {}
  const bags::Contents& contents() const override { return contents_; }
  void select(const bags::Selection&) override { next_ = 0; }
  std::optional<bags::Message> next() override {
    return next_ < messages_.size() ? std::optional(messages_[next_++]) : std::nullopt;
  }

 private:
  bags::Contents contents_;
  std::vector<bags::Message> messages_;
  std::size_t next_ = 0;
};

/// Frames as lists of (channel, stamp [ms]).
using Frames = std::vector<std::vector<std::pair<std::size_t, std::int64_t>>>;

Frames frames_of(std::vector<bags::Message> messages) {
  Messages bag(std::move(messages));
  BagFrames frames(bag, {Role::kColor, Role::kPart, Role::kOther, std::nullopt});
  Frames found;
  while (const auto frame = frames.next()) {
    found.emplace_back();
    for (const bags::Message& m : frame->messages) {
      found.back().emplace_back(m.channel, bags::leading_stamp(m.data)->nanoseconds / 1'000'000);
    }
    EXPECT_EQ(found.back().back(), std::pair(kColorChannel, frame->stamp.nanoseconds / 1'000'000));
  }
  return found;
}

std::vector<bags::Message> recording(int frames) {
  std::vector<bags::Message> messages;
  for (int i = 0; i < frames; ++i) {
    const std::int64_t t = 100 * i;
    messages.push_back(message(kColorChannel, t, t));
    messages.push_back(message(kDepthChannel, t, t));
    for (int k = 0; k < 5; ++k) messages.push_back(message(kOdometryChannel, t + 20 * k, t + 20 * k));
  }
  return messages;
}

TEST(LeadingStamp, IsReadInBothByteOrders) {
  EXPECT_EQ(bags::leading_stamp(cdr(1234)), time::Time{1'234'000'000});
  EXPECT_EQ(bags::leading_stamp({0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 5}), time::Time{2'000'000'005});
  EXPECT_EQ(bags::leading_stamp({0, 1, 0, 0, 1, 0, 0, 0}), std::nullopt);
  EXPECT_EQ(bags::leading_stamp({0, 7, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}), std::nullopt);          // XCDR2
  EXPECT_EQ(bags::leading_stamp({0, 1, 0, 0, 1, 0, 0, 0, 255, 255, 255, 255}), std::nullopt);  // no time
}

TEST(BagFrames, HaveWhatBelongsTogether) {
  const Frames frames = frames_of(recording(3));
  using Pair = std::pair<std::size_t, std::int64_t>;
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_THAT(frames[0], ElementsAre(Pair{1, 0}, Pair{2, 0}, Pair{0, 0}));
  EXPECT_THAT(frames[1], ElementsAre(Pair{2, 20}, Pair{2, 40}, Pair{2, 60}, Pair{2, 80}, Pair{1, 100}, Pair{2, 100},
                                     Pair{0, 100}));
}

TEST(BagFrames, DoNotDependOnTheOrderOfRecording) {
  const auto messages = recording(30);
  const Frames expected = frames_of(messages);
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    auto shuffled = messages;
    for (bags::Message& m : shuffled) m.log_time_ns += static_cast<std::int64_t>(random() % 200'000'000);
    std::stable_sort(shuffled.begin(), shuffled.end(),
                     [](const auto& a, const auto& b) { return a.log_time_ns < b.log_time_ns; });
    // Within a topic the order is that of its publisher.
    std::map<std::size_t, std::vector<bags::Message>> sent;
    std::map<std::size_t, std::size_t> next;
    for (const bags::Message& m : messages) sent[m.channel].push_back(m);
    for (bags::Message& m : shuffled) m.data = sent[m.channel][next[m.channel]++].data;
    EXPECT_TRUE(frames_of(shuffled) == expected) << trial;
  }
}

TEST(BagFrames, JoinDepthWithTheNearestImage) {
  std::vector<bags::Message> messages;
  for (int i = 0; i < 4; ++i) {
    messages.push_back(message(kColorChannel, 100 * i, 100 * i));
    messages.push_back(message(kDepthChannel, 100 * i + 40, 100 * i + 40));
  }
  const Frames frames = frames_of(messages);
  ASSERT_EQ(frames.size(), 4U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto t = 100 * static_cast<std::int64_t>(i);
    EXPECT_THAT(frames[i], ElementsAre(std::pair(kDepthChannel, t + 40), std::pair(kColorChannel, t)));
  }
}

TEST(BagFrames, DoNotWaitForTopicsThatFallSilent) {
  std::vector<bags::Message> messages = recording(2);
  for (int i = 2; i < 30; ++i) messages.push_back(message(kColorChannel, 100 * i, 100 * i));
  EXPECT_EQ(frames_of(messages).size(), 30U);
}

TEST(BagFrames, LeaveOutWhatHasNoStampAndWhatIsNotPlayed) {
  Messages bag({message(kStrangeChannel, 0, 0), {kDepthChannel, 0, 0, 0, {0, 1}}, message(kColorChannel, 5, 5)});
  BagFrames frames(bag, {Role::kColor, Role::kPart, Role::kOther, std::nullopt});
  const auto frame = frames.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->messages.size(), 1U);
  EXPECT_EQ(frames.unreadable(), 1U);
  EXPECT_FALSE(frames.next());
  EXPECT_THAT(frames_of({}), IsEmpty());
}

}  // namespace
}  // namespace lapis::sensor_replay
