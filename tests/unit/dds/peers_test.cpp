#include "common/dds/peers.hpp"

#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

/// An endpoint (`entity`) of a participant.
Gid gid(std::uint8_t participant, std::uint8_t entity = 0) {
  Gid out{};
  out[0] = participant;
  out[15] = entity;
  return out;
}

TEST(Peers, KinshipIsThatOfTheParticipant) {
  Peers peers("a");
  peers.add(gid(1), "enclave=/;run=a;");
  peers.add(gid(2), "enclave=/;run=b;");
  peers.add(gid(3), "enclave=/;");
  EXPECT_EQ(peers.kinship(gid(1, 7)), Kinship::kOwnRun);
  EXPECT_EQ(peers.kinship(gid(2, 7)), Kinship::kOtherRun);
  EXPECT_EQ(peers.kinship(gid(3, 7)), Kinship::kNoRun);
  EXPECT_EQ(peers.kinship(gid(4, 7)), Kinship::kNoRun) << "not found yet";
  EXPECT_EQ(peers.run_of(gid(2, 9)), "b");
  EXPECT_EQ(peers.run_of(gid(3, 9)), "");
  EXPECT_EQ(peers.run_of(gid(4, 9)), "");
}

TEST(Peers, ProcessWithoutARunKnowsNoOtherRun) {
  Peers peers("");
  peers.add(gid(1), "run=b;");
  EXPECT_EQ(peers.kinship(gid(1)), Kinship::kNoRun);
  EXPECT_TRUE(peers.take_other_runs().empty());
}

TEST(Peers, OnlyTheKeyRunNamesTheRun) {
  Peers peers("a");
  for (const char* user_data : {"", "run", "run=", "run=;", "rerun=b;", "enclave=run=b;", ";;=;"}) {
    peers.add(gid(1), user_data);
    EXPECT_EQ(peers.kinship(gid(1)), Kinship::kNoRun) << user_data;
  }
  peers.add(gid(2), "run=b");  // the last semicolon may be missing
  EXPECT_EQ(peers.kinship(gid(2)), Kinship::kOtherRun);
}

TEST(Peers, EachOtherRunIsTakenOnce) {
  Peers peers("a");
  for (std::uint8_t i = 1; i < 4; ++i) peers.add(gid(i), "run=b;");
  peers.add(gid(4), "run=a;");
  EXPECT_EQ(peers.take_other_runs(), std::vector<std::string>{"b"});
  peers.add(gid(5), "run=b;");
  EXPECT_TRUE(peers.take_other_runs().empty());
  peers.add(gid(6), "run=c;");
  EXPECT_EQ(peers.take_other_runs(), std::vector<std::string>{"c"});
}

}  // namespace
}  // namespace lapis::dds
