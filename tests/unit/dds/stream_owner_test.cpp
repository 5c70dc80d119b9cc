#include "common/dds/stream_owner.hpp"

#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

using std::chrono::milliseconds;

Gid gid(std::uint8_t participant) {
  Gid out{};
  out[0] = participant;
  return out;
}

/// A reader of run "a": participants 1 to 9 belong to it, 11 to 19 name no run, 21 to 29 belong to run "b".
class StreamOwnerTest : public ::testing::Test {
 protected:
  StreamOwnerTest() { introduce(peers_); }
  static void introduce(Peers& peers) {
    for (std::uint8_t i = 1; i < 10; ++i) peers.add(gid(i), "run=a;");
    for (std::uint8_t i = 21; i < 30; ++i) peers.add(gid(i), "run=b;");
  }
  bool accepts(std::uint8_t writer, int at_ms = 0) {
    return owner_.accepts(gid(writer), StreamOwner::Clock::time_point(milliseconds(at_ms)));
  }
  void match(std::initializer_list<std::uint8_t> writers) {
    for (const auto writer : writers) owner_.match(gid(writer));
  }

  Peers peers_{"a"};
  StreamOwner owner_{peers_, true};
};

TEST_F(StreamOwnerTest, AnotherRunIsRefused) {
  match({21});
  EXPECT_FALSE(accepts(21));
  EXPECT_EQ(owner_.matched(), 0u) << "and does not count";
  EXPECT_TRUE(owner_.is_matched(gid(21)));
  StreamOwner of_many(peers_, false);
  of_many.match(gid(21));
  EXPECT_FALSE(of_many.accepts(gid(21), {})) << "even on a topic of many writers";
}

TEST_F(StreamOwnerTest, ManyWritersAreAcceptedWhereTheTopicHasMany) {
  StreamOwner of_many(peers_, false);
  for (const std::uint8_t writer : {1, 2, 11, 12, 1, 11}) EXPECT_TRUE(of_many.accepts(gid(writer), {})) << int{writer};
}

TEST_F(StreamOwnerTest, ProcessWithoutARunAcceptsAll) {
  Peers none("");
  introduce(none);
  StreamOwner owner(none, true);
  for (const std::uint8_t writer : {1, 21, 11, 1, 12, 21}) EXPECT_TRUE(owner.accepts(gid(writer), {})) << int{writer};
}

TEST_F(StreamOwnerTest, RestartedProcessTakesThePlaceOfTheOneBefore) {
  match({1});
  EXPECT_TRUE(accepts(1));
  match({2});  // the first one's lease has not expired yet
  EXPECT_TRUE(accepts(1)) << "until its successor speaks";
  EXPECT_TRUE(accepts(2));
  EXPECT_FALSE(accepts(1)) << "what of it was still under way";
  owner_.unmatch(gid(1));
  EXPECT_FALSE(accepts(1));
  EXPECT_TRUE(accepts(2));
}

TEST_F(StreamOwnerTest, LastSamplesOfAProcessThatHasLeftAreAccepted) {
  match({1});
  owner_.unmatch(gid(1));
  EXPECT_TRUE(accepts(1));
}

TEST_F(StreamOwnerTest, StrangerIsAcceptedOnlyWhereTheRunDoesNotSpeak) {
  match({1, 11});
  EXPECT_TRUE(accepts(11)) << "process 1 publishes nothing: the stranger takes its part";
  EXPECT_TRUE(accepts(1)) << "the run's own process comes first";
  EXPECT_FALSE(accepts(11, 60'000)) << "however long it is silent, as latched topics are";
  owner_.unmatch(gid(1));
  EXPECT_TRUE(accepts(11)) << "it has left";
}

TEST_F(StreamOwnerTest, FirstStrangerKeepsTheStreamWhileItSpeaks) {
  match({11, 12});
  EXPECT_TRUE(accepts(11, 0));
  EXPECT_FALSE(accepts(12, 500));
  EXPECT_TRUE(accepts(11, 900));
  EXPECT_FALSE(accepts(12, 1900));
  EXPECT_TRUE(accepts(12, 1901)) << "the first one has been silent for a second";
  EXPECT_FALSE(accepts(11, 2000));
  owner_.unmatch(gid(12));
  EXPECT_TRUE(accepts(11, 2001));
}

TEST_F(StreamOwnerTest, MatchesOfAParticipantAreFoundByAnyOfItsEndpoints) {
  match({1});
  Gid endpoint = gid(1);
  endpoint[15] = 9;
  EXPECT_TRUE(owner_.is_participant_matched(endpoint));
  EXPECT_FALSE(owner_.is_participant_matched(gid(2)));
  owner_.unmatch(gid(1));
  EXPECT_FALSE(owner_.is_participant_matched(endpoint));
}

}  // namespace
}  // namespace lapis::dds
