#include "planner/core/decision/explanation.hpp"

#include <gtest/gtest.h>

namespace lapis::planner {
namespace {

Candidate to_frontier(std::uint32_t id, double nats, double cost_m) {
  Candidate candidate;
  candidate.frontier = id;
  candidate.value.path_information = nats;
  candidate.value.cost_m = cost_m;
  candidate.utility = nats / cost_m;
  return candidate;
}

constexpr Asks kInformation{.path_information = true};

TEST(Explanation, NamesTheChoiceAndTheBestThatLeadsElsewhere) {
  std::vector<Candidate> all{to_frontier(7, 150.0, 3.0), to_frontier(12, 212.4, 4.0), to_frontier(12, 208.0, 4.0),
                             to_frontier(3, 900.0, 1.0)};
  all[3].rejection = Rejection::kUnreachable;
  EXPECT_EQ(explain(all, 1, kInformation),
            "frontier 12: 212 nats for 4.0 m, 53.1; next best is frontier 7: 150 nats for 3.0 m, 50");
}

TEST(Explanation, SaysThatAGoalIsKept) {
  const std::vector<Candidate> all{to_frontier(7, 150.0, 3.0), to_frontier(12, 220.0, 4.0)};
  EXPECT_EQ(explain(all, 0, kInformation),
            "frontier 7: 150 nats for 3.0 m, 50, is kept although better is frontier 12: 220 nats for 4.0 m, 55");
}

TEST(Explanation, HasOnlyWhatTheMethodJudgesBy) {
  std::vector<Candidate> all{to_frontier(7, 150.0, 3.0)};
  EXPECT_EQ(explain(all, 0, {}), "frontier 7: 3.0 m, 50; there is no other");
  all[0].kind = CandidateKind::kRevisit;
  all[0].value.unknown_share = 0.25;
  all[0].loops = {{.probability = 0.8}, {.probability = 0.4}};
  EXPECT_EQ(explain(all, 0, {.spectrum = true, .unknown_share = true}),
            "an old place: 25 % unknown, loops with 1.2 old places for 3.0 m, 50; there is no other");
}

}  // namespace
}  // namespace lapis::planner
