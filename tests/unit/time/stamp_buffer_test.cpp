#include "common/time/stamp_buffer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

namespace lapis::time {
namespace {

using Buffer = StampBuffer<std::string>;

constexpr Duration kTolerance{10'000'000};

Time at_ms(std::int64_t milliseconds) { return {milliseconds * 1'000'000}; }

Push push(Buffer& buffer, std::int64_t milliseconds) {
  return buffer.push(at_ms(milliseconds), std::to_string(milliseconds));
}

std::vector<std::string> drain(Buffer& buffer) {
  std::vector<std::string> out;
  while (!buffer.empty()) {
    const Time stamp = buffer.front().first;
    out.push_back(buffer.front().second);
    buffer.drop_until(stamp);
  }
  return out;
}

TEST(StampBuffer, KeepsTheOrderOfStampsWhateverTheOrderOfArrival) {
  std::vector<std::int64_t> stamps = {0, 33, 66, 100, 133, 166};
  do {
    Buffer buffer;
    for (const auto stamp : stamps) ASSERT_EQ(push(buffer, stamp), Push::kStored);
    ASSERT_EQ(drain(buffer), (std::vector<std::string>{"0", "33", "66", "100", "133", "166"}));
  } while (std::next_permutation(stamps.begin(), stamps.end()));
}

TEST(StampBuffer, RefusesWhatIsThereAndWhatWasTaken) {
  Buffer buffer;
  push(buffer, 33);
  push(buffer, 66);
  EXPECT_EQ(push(buffer, 33), Push::kDuplicate);
  buffer.drop_until(at_ms(33));
  EXPECT_EQ(push(buffer, 33), Push::kDuplicate);
  EXPECT_EQ(push(buffer, 32), Push::kLate);
  EXPECT_EQ(push(buffer, 66), Push::kDuplicate);
  EXPECT_EQ(drain(buffer), (std::vector<std::string>{"66"}));
}

TEST(StampBuffer, FullBufferDropsItsOldestAndSaysSo) {
  Buffer buffer(3);
  for (const auto stamp : {0, 33, 66}) EXPECT_EQ(push(buffer, stamp), Push::kStored);
  EXPECT_EQ(push(buffer, 100), Push::kOverflow);
  EXPECT_EQ(drain(buffer), (std::vector<std::string>{"33", "66", "100"}));
}

TEST(StampBuffer, SourceThatBeginsAnewIsFollowed) {
  Buffer buffer;
  push(buffer, 5000);
  push(buffer, 5033);
  buffer.drop_until(at_ms(5033));
  EXPECT_EQ(push(buffer, 5033 - 999), Push::kLate);
  EXPECT_EQ(push(buffer, 100), Push::kRestarted);
  EXPECT_EQ(push(buffer, 133), Push::kStored);
  EXPECT_EQ(drain(buffer), (std::vector<std::string>{"100", "133"}));
}

TEST(StampBuffer, OneStampFarInTheFutureDoesNotBlockTheStream) {
  Buffer buffer;
  push(buffer, 0);
  push(buffer, 100'000'000);
  EXPECT_EQ(push(buffer, 33), Push::kRestarted);
  EXPECT_EQ(push(buffer, 66), Push::kStored);
  EXPECT_EQ(drain(buffer), (std::vector<std::string>{"33", "66"}));
}

TEST(StampBuffer, MatchFindsTheNearestWithinTolerance) {
  Buffer buffer;
  for (const auto stamp : {0, 30, 40, 100}) push(buffer, stamp);
  std::string* found = nullptr;
  EXPECT_EQ(buffer.match(at_ms(33), kTolerance, false, found), Match::kFound);
  EXPECT_EQ(*found, "30");
  EXPECT_EQ(buffer.match(at_ms(38), kTolerance, false, found), Match::kFound);
  EXPECT_EQ(*found, "40");
  EXPECT_EQ(buffer.match(at_ms(60), kTolerance, false, found), Match::kMissing);
  EXPECT_EQ(found, nullptr);
}

TEST(StampBuffer, MatchWaitsWhileABetterOneMayCome) {
  Buffer buffer;
  std::string* found = nullptr;
  EXPECT_EQ(buffer.match(at_ms(33), kTolerance, false, found), Match::kWait);
  EXPECT_EQ(buffer.match(at_ms(33), kTolerance, true, found), Match::kMissing);
  push(buffer, 30);
  EXPECT_EQ(buffer.match(at_ms(33), kTolerance, false, found), Match::kWait);
  EXPECT_EQ(buffer.match(at_ms(33), kTolerance, true, found), Match::kFound);
  push(buffer, 33);
  EXPECT_EQ(buffer.match(at_ms(33), kTolerance, false, found), Match::kFound);
  EXPECT_EQ(*found, "33");
}

TEST(StampBuffer, StreamThatHasNotBegunAnewYetIsWaitedFor) {
  Buffer buffer;
  for (const auto stamp : {5000, 5033}) push(buffer, stamp);
  std::string* found = nullptr;
  buffer.expect_restart(at_ms(100));
  EXPECT_EQ(buffer.match(at_ms(100), kTolerance, false, found), Match::kWait);
  push(buffer, 5066);  // still of before
  EXPECT_EQ(buffer.match(at_ms(100), kTolerance, false, found), Match::kWait);
  EXPECT_EQ(push(buffer, 100), Push::kRestarted);
  EXPECT_EQ(buffer.match(at_ms(100), kTolerance, false, found), Match::kFound);
  EXPECT_EQ(buffer.match(at_ms(66), kTolerance, false, found), Match::kMissing);
}

TEST(StampBuffer, StreamThatContinuesIsNotExpectedToBeginAnew) {
  Buffer buffer;
  for (const auto stamp : {0, 33, 66}) push(buffer, stamp);
  std::string* found = nullptr;
  buffer.expect_restart(at_ms(50));
  EXPECT_EQ(buffer.match(at_ms(50), kTolerance, false, found), Match::kMissing);
  push(buffer, 5000);
  EXPECT_EQ(buffer.match(at_ms(50), kTolerance, false, found), Match::kMissing);
  buffer.expect_restart(at_ms(50));  // does not come, but the other stream catches up
  EXPECT_EQ(buffer.match(at_ms(50), kTolerance, true, found), Match::kMissing);
  EXPECT_EQ(buffer.match(at_ms(4500), kTolerance, false, found), Match::kMissing);
}

TEST(StampBuffer, StreamThatBeganAnewAloneIsNotHeldBack) {
  Buffer buffer;
  push(buffer, 5000);
  EXPECT_EQ(push(buffer, 100), Push::kRestarted);
  buffer.drop_until(at_ms(5033));  // the other stream is where it was
  EXPECT_EQ(push(buffer, 133), Push::kStored);
  EXPECT_EQ(drain(buffer), (std::vector<std::string>{"133"}));
}

TEST(StampBuffer, ReportsHowManyItForgot) {
  Buffer buffer;
  EXPECT_EQ(buffer.second(), std::nullopt);
  for (const auto stamp : {0, 33, 66}) push(buffer, stamp);
  EXPECT_EQ(buffer.second(), at_ms(33));
  EXPECT_EQ(buffer.drop_until(at_ms(50)), 2U);
  EXPECT_EQ(buffer.drop_until(at_ms(50)), 0U);
  EXPECT_EQ(buffer.size(), 1U);
}

// Colour and depth streams, each in its own order, interleaved at random. Joined pairs must not depend on it.
class Join {
 public:
  void color(std::int64_t ms) {
    if (push(color_, ms) == Push::kRestarted) depth_.expect_restart(color_.front().first);
    advance(false);
  }
  void depth(std::int64_t ms) {
    push(depth_, ms);
    advance(false);
  }
  std::vector<std::string> finish() {
    advance(true);
    return pairs_;
  }

 private:
  void advance(bool is_complete) {
    while (!color_.empty()) {
      auto& [stamp, message] = color_.front();
      std::string* found = nullptr;
      const auto match = depth_.match(stamp, kTolerance, is_complete, found);
      if (match == Match::kWait) return;
      pairs_.push_back(message + (match == Match::kFound ? "+" + *found : "+none"));
      depth_.drop_until(stamp - kTolerance);
      color_.drop_until(stamp);
    }
  }
  Buffer color_{64};
  Buffer depth_{64};
  std::vector<std::string> pairs_;
};

std::vector<std::string> join(const std::vector<std::int64_t>& color, const std::vector<std::int64_t>& depth,
                              std::mt19937& random) {
  Join joined;
  std::size_t c = 0;
  std::size_t d = 0;
  while (c < color.size() || d < depth.size()) {
    const bool takes_color = d == depth.size() || (c < color.size() && random() % 2 == 0);
    if (takes_color) {
      joined.color(color[c++]);
    } else {
      joined.depth(depth[d++]);
    }
  }
  return joined.finish();
}

TEST(StampBuffer, JoiningDoesNotDependOnArrivalBetweenStreams) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<std::int64_t> color;
    std::vector<std::int64_t> depth;
    for (std::int64_t t = 0; t < 20; ++t) {
      const auto jitter = static_cast<std::int64_t>(random() % 15);
      if (random() % 5 != 0) color.push_back(t * 33);
      if (random() % 5 != 0) depth.push_back(t * 33 + jitter);
    }
    const auto expected = join(color, depth, random);
    ASSERT_EQ(expected.size(), color.size());
    for (int order = 0; order < 20; ++order) ASSERT_EQ(join(color, depth, random), expected);
  }
}

// Frames of before may be lost when the depth images that they wait for are gone; none of after is.
TEST(StampBuffer, RestartOfBothStreamsCostsNoFrameThatFollowsWhateverArrivesFirst) {
  std::vector<std::int64_t> stamps;
  for (const std::int64_t first : {5000, 0}) {
    for (std::int64_t t = 0; t < 10; ++t) stamps.push_back(first + 33 * t);
  }
  const std::vector<std::string> expected = {"0+0",     "33+33",   "66+66",   "99+99",   "132+132",
                                             "165+165", "198+198", "231+231", "264+264", "297+297"};
  std::mt19937 random(7);
  for (int order = 0; order < 1000; ++order) {
    const auto pairs = join(stamps, stamps, random);
    ASSERT_GE(pairs.size(), expected.size()) << order;
    ASSERT_EQ(std::vector<std::string>(pairs.end() - 10, pairs.end()), expected) << order;
  }
}

}  // namespace
}  // namespace lapis::time
