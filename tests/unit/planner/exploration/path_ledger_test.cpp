#include "planner/core/exploration/path_ledger.hpp"

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

time::Time second(double seconds) { return time::Time::from_seconds(seconds); }

Candidate candidate(double x_m, double cost_m, double nats) {
  Candidate c;
  c.target_map = {x_m, 0.0};
  c.value.cost_m = cost_m;
  c.value.path_information = nats;
  return c;
}

TEST(PathLedger, SettlesAPathWhenAnotherTargetIsChosen) {
  PathLedger ledger(0.75);
  const Candidate first = candidate(1.0, 5.0, 40.0), later = candidate(1.3, 2.0, 10.0), last = candidate(1.7, 1.0, 4.0),
                  other = candidate(1.8, 7.0, 70.0);
  EXPECT_EQ(ledger.note(&first, 100.0, second(1.0)), std::nullopt);
  EXPECT_EQ(ledger.note(&later, 120.0, second(2.0)), std::nullopt);
  EXPECT_EQ(ledger.note(&last, 130.0, second(3.0)), std::nullopt) << "it has crept forward";
  const DrivenPath expected{second(1.0), second(4.0), CandidateKind::kFrontier, 5.0, 1.0, 40.0, 4.0, 35.0};
  EXPECT_EQ(ledger.note(&other, 135.0, second(4.0)), expected);
}

TEST(PathLedger, SettlesAPathWhenNothingIsChosen) {
  PathLedger ledger(0.75);
  EXPECT_EQ(ledger.note(nullptr, 50.0, second(0.0)), std::nullopt);
  const Candidate only = candidate(1.0, 5.0, 40.0);
  EXPECT_EQ(ledger.note(&only, 60.0, second(1.0)), std::nullopt);
  const auto ended = ledger.note(nullptr, 61.0, second(2.0));
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->gained_nats, 1.0);
  EXPECT_EQ(ledger.note(nullptr, 62.0, second(3.0)), std::nullopt) << "it is settled once";
}

}  // namespace
}  // namespace lapis::planner
