#include "common/dds/stream_owner.hpp"

#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

using std::chrono::milliseconds;

Gid writer(std::uint8_t participant) {
  Gid out{};
  out[0] = participant;
  return out;
}

/// A reader of run "a": participants 1 to 9 belong to it, 11 to 19 name no run, 21 to 29 belong to run "b".
class StreamOwnerTest : public ::testing::Test {
 protected:
  StreamOwnerTest() {
    for (std::uint8_t i = 1; i < 10; ++i) peers_.add(writer(i), "run=a;");
    for (std::uint8_t i = 21; i < 30; ++i) peers_.add(writer(i), "run=b;");
  }
  /// A sample arrives and is taken. Writers of runs sign theirs.
  bool takes(std::uint8_t number, int at_ms = 0) {
    const bool is_signed = number < 11 || number > 20;
    const StreamOwner::Clock::time_point now{milliseconds(at_ms)};
    return owner_.admits(is_signed ? std::optional(writer(number)) : std::nullopt) &&
           owner_.accepts(writer(number), now);
  }
  void match(std::initializer_list<std::uint8_t> numbers) {
    for (const auto number : numbers) owner_.match(writer(number));
  }

  Peers peers_{"a"};
  StreamOwner owner_{peers_};
};

TEST_F(StreamOwnerTest, AnotherRunIsRefused) {
  match({21});
  EXPECT_FALSE(takes(21));
  EXPECT_FALSE(owner_.accepts(writer(21), {})) << "even if it does not sign";
  EXPECT_EQ(owner_.matched(), 0u) << "and does not count";
  EXPECT_TRUE(owner_.is_matched(writer(21)));
}

TEST_F(StreamOwnerTest, RestartedProcessTakesThePlaceOfTheOneBefore) {
  match({1});
  EXPECT_TRUE(takes(1));
  match({2});  // the first one's lease has not expired yet
  EXPECT_TRUE(takes(1)) << "until its successor speaks";
  EXPECT_TRUE(takes(2));
  EXPECT_FALSE(takes(1)) << "what of it was still under way";
  owner_.unmatch(writer(1));
  EXPECT_FALSE(takes(1));
  match({1});
  EXPECT_FALSE(takes(1)) << "nor when it is found again";
  EXPECT_TRUE(takes(2));
}

TEST_F(StreamOwnerTest, SuccessorIsAcceptedBeforeItIsMatched) {
  match({1});
  EXPECT_TRUE(takes(1));
  EXPECT_TRUE(takes(2)) << "its first sample may come before DDS reports the match";
  match({2});
  EXPECT_FALSE(takes(1));
}

TEST_F(StreamOwnerTest, ProcessOfARunThatDiscoveryHasNotFoundYetIsAccepted) {
  match({1});
  EXPECT_TRUE(takes(1));
  EXPECT_TRUE(takes(99));
  EXPECT_TRUE(takes(1)) << "but it does not get the stream";
}

TEST_F(StreamOwnerTest, LastSamplesOfAProcessThatHasLeftAreAccepted) {
  match({1});
  owner_.unmatch(writer(1));
  EXPECT_TRUE(takes(1));
}

TEST_F(StreamOwnerTest, StrangerIsAcceptedOnlyWhereTheRunDoesNotSpeak) {
  match({1, 11});
  EXPECT_TRUE(takes(11)) << "process 1 publishes nothing: the stranger takes its part";
  EXPECT_TRUE(takes(1)) << "the run's own process comes first";
  EXPECT_FALSE(takes(11, 60'000)) << "however long it is silent, as latched topics are";
  owner_.unmatch(writer(1));
  EXPECT_TRUE(takes(11)) << "it has left";
}

TEST_F(StreamOwnerTest, FirstStrangerKeepsTheStreamWhileItSpeaks) {
  match({11, 12});
  EXPECT_TRUE(takes(11, 0));
  EXPECT_FALSE(takes(12, 500));
  EXPECT_TRUE(takes(11, 900));
  EXPECT_FALSE(takes(12, 1900));
  EXPECT_TRUE(takes(12, 1901)) << "the first one has been silent for a second";
  EXPECT_FALSE(takes(11, 2000));
  owner_.unmatch(writer(12));
  EXPECT_TRUE(takes(11, 2001));
}

TEST_F(StreamOwnerTest, NobodyWaitsForAWriterThatIsRefused) {
  match({1, 11, 21});
  EXPECT_TRUE(owner_.refuses(writer(21)));
  EXPECT_FALSE(owner_.refuses(writer(11)));
  EXPECT_TRUE(takes(1));
  EXPECT_FALSE(owner_.refuses(writer(1)));
  EXPECT_TRUE(owner_.refuses(writer(11)));
  match({2});
  EXPECT_FALSE(owner_.refuses(writer(1))) << "until its successor speaks";
  EXPECT_FALSE(owner_.refuses(writer(2)));
  EXPECT_TRUE(takes(2));
  EXPECT_TRUE(owner_.refuses(writer(1)));
  EXPECT_FALSE(owner_.refuses(writer(3))) << "it would be the next successor";
  owner_.unmatch(writer(2));
  EXPECT_TRUE(owner_.refuses(writer(1)));
  EXPECT_FALSE(owner_.refuses(writer(11)));
}

TEST_F(StreamOwnerTest, OnlyStrangersAreInterrupted) {
  match({1, 11});
  EXPECT_TRUE(takes(11));
  EXPECT_FALSE(owner_.was_interrupted(writer(11)));
  EXPECT_TRUE(takes(1));
  EXPECT_FALSE(takes(11));
  EXPECT_FALSE(owner_.was_interrupted(writer(1))) << "none of its samples was refused";
  owner_.unmatch(writer(1));
  EXPECT_TRUE(takes(11));
  EXPECT_TRUE(owner_.was_interrupted(writer(11)));
  EXPECT_TRUE(takes(11));
  EXPECT_FALSE(owner_.was_interrupted(writer(11))) << "asked once";
}

TEST_F(StreamOwnerTest, MatchesOfAParticipantAreFoundByAnyOfItsEndpoints) {
  match({1});
  Gid endpoint = writer(1);
  endpoint[15] = 9;
  EXPECT_TRUE(owner_.is_participant_matched(endpoint));
  EXPECT_FALSE(owner_.is_participant_matched(writer(2)));
  owner_.unmatch(writer(1));
  EXPECT_FALSE(owner_.is_participant_matched(endpoint));
}

}  // namespace
}  // namespace lapis::dds
