#include "planner/decision_plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using Plan = nlohmann::json;

/// Two free cells under an occupied one; what is around them is unknown.
Surroundings corner() {
  test::FlatMap map(0.25);
  map.set({2, 3}, mapping::kFree);
  map.set({3, 3}, mapping::kFree);
  map.set({3, 4}, mapping::kOccupied);
  Surroundings surroundings({}, mapping::SensorModel{}, 0.25);
  surroundings.update_map(map.map(), map.flush());
  return surroundings;
}

Decision with_judged(int candidates) {
  Decision decision;
  decision.candidates.resize(static_cast<std::size_t>(candidates) + 1);
  decision.candidates.front().points = {{0.5, 0.75}, {1.0, 2.0}};
  decision.candidates.back().rejection = Rejection::kUnreachable;
  decision.chosen = 0;
  decision.promised.push_back({{{0.5, 0.75}, 1.0}, 3.0});
  return decision;
}

class DecisionPlanTest : public ::testing::Test {
 protected:
  Plan read() const { return Plan::parse(std::ifstream(file_)); }

  lapis::test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / DecisionPlan::kFile;
  const Surroundings surroundings_ = corner();
};

TEST_F(DecisionPlanTest, ShowsWhatWasKnown) {
  DecisionPlan plan(file_.string());
  ASSERT_EQ(plan.write(with_judged(2), surroundings_, 7), std::nullopt);
  const Plan written = read();
  EXPECT_EQ(written["decision"], 7);
  EXPECT_EQ(written["robot_m"], (Plan{0.5, 0.75}));
  EXPECT_EQ(written["plan"]["lower_left_m"], (Plan{0.5, 0.75}));
  EXPECT_EQ(written["plan"]["rows"], (Plan{"..", " #"}));
  ASSERT_EQ(written["frontiers"].size(), 1U);
  EXPECT_EQ(written["frontiers"][0]["cells_m"], Plan::parse("[[0.625, 0.875], [0.875, 0.875]]"));
  ASSERT_EQ(written["paths_m"].size(), 3U) << "as many as rows in decisions.csv";
  EXPECT_EQ(written["paths_m"][0], Plan::parse("[[0.5, 0.75], [1.0, 2.0]]"));
}

TEST_F(DecisionPlanTest, KeepsTheDecisionWithMostJudgedCandidates) {
  DecisionPlan plan(file_.string());
  std::uint64_t id = 0;
  for (const int judged : {1, 3, 3, 2}) ASSERT_EQ(plan.write(with_judged(judged), surroundings_, ++id), std::nullopt);
  EXPECT_EQ(read()["decision"], 2);
  Decision nothing = with_judged(5);
  nothing.chosen.reset();
  ASSERT_EQ(plan.write(nothing, surroundings_, 9), std::nullopt);
  EXPECT_EQ(read()["decision"], 2);
}

TEST_F(DecisionPlanTest, AnEmptyMapHasAnEmptyPlan) {
  DecisionPlan plan(file_.string());
  ASSERT_EQ(plan.write(with_judged(1), Surroundings({}, mapping::SensorModel{}, 0.25), 1), std::nullopt);
  EXPECT_TRUE(read()["plan"]["rows"].empty());
}

TEST_F(DecisionPlanTest, SetsAnOlderFileAside) {
  {
    DecisionPlan plan(file_.string());
    ASSERT_EQ(plan.write(with_judged(1), surroundings_, 1), std::nullopt);
  }
  DecisionPlan plan(file_.string());
  EXPECT_FALSE(std::filesystem::exists(file_));
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "decision.1.json"));
}

TEST_F(DecisionPlanTest, FileThatCannotBeWrittenIsNamed) {
  const std::string path = (folder_.path() / "none" / "decision.json").string();
  DecisionPlan plan(path);
  const auto problem = plan.write(with_judged(1), surroundings_, 1);
  ASSERT_TRUE(problem);
  EXPECT_THAT(*problem, ::testing::HasSubstr(path));
}

}  // namespace
}  // namespace lapis::planner
