#include "planner/decision_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <stdexcept>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace lapis::planner {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Row = std::vector<std::string>;

constexpr time::Time kStamp{1'000'000'000};

/// RFC 4180, without line breaks inside of cells.
Row cells_of(const std::string& line) {
  Row cells{""};
  bool is_quoted = false;
  for (const char c : line) {
    if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      cells.emplace_back();
    } else {
      cells.back() += c;
    }
  }
  return cells;
}

std::vector<Row> read(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::vector<Row> rows;
  for (std::string line; std::getline(in, line);) rows.push_back(cells_of(line));
  return rows;
}

// A chosen candidate with a number of its own in every column, and a rejected one.
Decision decision() {
  Decision decision;
  decision.candidates.resize(2);
  Candidate& chosen = decision.candidates[0];
  chosen.kind = CandidateKind::kAlternative;
  chosen.frontier = 17;
  chosen.goal = {{1.5, -2.5}, 0.25};
  chosen.value = {3.5, 4.5, 5.5, 6.5, 7.5};
  chosen.value.unknown_share = 0.125;
  decision.known = {true, true, true, true};
  chosen.loops.resize(2);
  chosen.gain = {0.0, 8.5, 9.5, 10.5};
  chosen.utility = 11.5;
  decision.candidates[1].frontier = 18;
  decision.candidates[1].rejection = Rejection::kUnreachable;
  decision.explanation = "frontier 4: best, by far";
  decision.chosen = 0;
  return decision;
}

DrivenPath driven_path() {
  return {time::Time::from_seconds(1.0),
          time::Time::from_seconds(3.5),
          CandidateKind::kRevisit,
          4.25,
          100.5,
          80.5,
          90.5,
          12.5,
          13.5};
}

class DecisionLogTest : public ::testing::Test {
 protected:
  test::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "decisions.csv";
};

TEST_F(DecisionLogTest, HasARowForEveryCandidateUnderTheRightHeadings) {
  DecisionLog log(file_.string());
  ASSERT_TRUE(log.write(decision(), driven_path(), 4, "joint", time::Time{1'700'000'012'066'666'666}));
  const auto rows = read(file_);
  ASSERT_EQ(rows.size(), 3U);
  for (const Row& row : rows) ASSERT_EQ(row.size(), rows[0].size());
  std::map<std::string, std::string> chosen;
  for (std::size_t i = 0; i < rows[0].size(); ++i) chosen[rows[0][i]] = rows[1][i];
  const std::map<std::string, std::string> expected{{"decision", "4"},
                                                    {"time_s", "1700000012.066666666"},
                                                    {"method", "joint"},
                                                    {"candidate", "0"},
                                                    {"kind", "alternative"},
                                                    {"frontier", "17"},
                                                    {"x_m", "1.5"},
                                                    {"y_m", "-2.5"},
                                                    {"yaw_rad", "0.25"},
                                                    {"cost_m", "3.5"},
                                                    {"path_information_nats", "4.5"},
                                                    {"goal_information_nats", "5.5"},
                                                    {"places", "2"},
                                                    {"loop_gain", "6.5"},
                                                    {"fixed_n_change", "8.5"},
                                                    {"end_sigma_without_loops_m", "9.5"},
                                                    {"end_sigma_m", "10.5"},
                                                    {"d_optimality", "7.5"},
                                                    {"unknown_share", "0.125"},
                                                    {"utility", "11.5"},
                                                    {"explanation", "frontier 4: best, by far"},
                                                    {"ended_kind", "revisit"},
                                                    {"ended_s", "2.5"},
                                                    {"ended_cost_m", "4.25"},
                                                    {"ended_promised_nats", "100.5"},
                                                    {"ended_driven_nats", "80.5"},
                                                    {"ended_gained_nats", "90.5"},
                                                    {"ended_promised_loop_gain", "12.5"},
                                                    {"ended_loop_gain", "13.5"},
                                                    {"is_chosen", "1"},
                                                    {"rejection", ""}};
  EXPECT_EQ(chosen, expected);
  const auto ended = std::find(rows[0].begin(), rows[0].end(), "ended_kind") - rows[0].begin();
  for (std::ptrdiff_t i = ended; i < ended + 8; ++i) EXPECT_EQ(rows[2][static_cast<std::size_t>(i)], "") << i;
}

TEST_F(DecisionLogTest, RejectionIsTheLastColumn) {
  DecisionLog log(file_.string());
  ASSERT_TRUE(log.write(decision(), {}, 1, "joint", kStamp));
  const auto rows = read(file_);
  EXPECT_EQ(rows[2].back(), "cannot be reached");
  EXPECT_EQ(rows[2][rows[2].size() - 2], "0") << "not chosen";
}

TEST_F(DecisionLogTest, SaysWhatOtherMethodsWouldHaveChosen) {
  Decision differs = decision();
  differs.candidates[1].rejection = Rejection::kNone;
  differs.by_compared_methods = {1, std::nullopt};
  DecisionLog log(file_.string(), {"mi_only", "ssmi"});
  ASSERT_TRUE(log.write(differs, {}, 1, "joint", kStamp));
  const auto rows = read(file_);
  EXPECT_THAT(Row(rows[0].end() - 4, rows[0].end()),
              ElementsAre("is_chosen", "is_chosen_by_mi_only", "is_chosen_by_ssmi", "rejection"));
  EXPECT_THAT(Row(rows[1].end() - 4, rows[1].end()), ElementsAre("1", "0", "0", ""));
  EXPECT_THAT(Row(rows[2].end() - 4, rows[2].end()), ElementsAre("0", "1", "0", ""));
}

TEST_F(DecisionLogTest, WhatNobodyAskedForIsEmpty) {
  Decision nearest = decision();
  nearest.known = {};
  DecisionLog log(file_.string());
  ASSERT_TRUE(log.write(nearest, {}, 1, "nearest", kStamp));
  const auto rows = read(file_);
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    const bool is_of_path = rows[0][i].ends_with("_nats") && !rows[0][i].starts_with("ended_");
    if (!is_of_path && rows[0][i] != "d_optimality" && rows[0][i] != "places") continue;
    EXPECT_EQ(rows[1][i], "") << rows[0][i];
  }
  EXPECT_EQ(rows[0].size(), rows[1].size());
}

TEST_F(DecisionLogTest, HasAColumnForEachPriorThatIsCompared) {
  Decision compared = decision();
  compared.by_compared_fields = {0, 1, std::nullopt};
  DecisionLog log(file_.string(), {}, {0.05, 0.1, 0.5});
  ASSERT_TRUE(log.write(compared, {}, 1, "joint", kStamp));
  const auto rows = read(file_);
  const auto last_of = [](const Row& row) { return Row(row.end() - 4, row.end() - 1); };
  EXPECT_THAT(last_of(rows[0]),
              ElementsAre("is_chosen_with_prior_0.05", "is_chosen_with_prior_0.1", "is_chosen_with_prior_0.5"));
  EXPECT_THAT(last_of(rows[1]), ElementsAre("1", "0", "0"));
  EXPECT_THAT(last_of(rows[2]), ElementsAre("0", "1", "0"));
}

TEST_F(DecisionLogTest, DecisionWithoutCandidatesHasNoRow) {
  DecisionLog log(file_.string());
  ASSERT_TRUE(log.write({}, driven_path(), 1, "joint", kStamp));
  EXPECT_EQ(read(file_).size(), 1U);
  ASSERT_TRUE(log.write(decision(), {}, 2, "joint", kStamp));
  const auto rows = read(file_);
  EXPECT_THAT(rows[1], ::testing::Contains("90.5")) << "what the path gained that had ended before";
  EXPECT_THAT(rows[2], ::testing::Not(::testing::Contains("90.5")));
}

TEST_F(DecisionLogTest, SetsAnOlderFileAside) {
  {
    DecisionLog log(file_.string());
    ASSERT_TRUE(log.write(decision(), {}, 1, "joint", kStamp));
  }
  DecisionLog log(file_.string());
  EXPECT_EQ(read(file_).size(), 1U);
  EXPECT_EQ(read(folder_.path() / "decisions.1.csv").size(), 3U);
}

TEST_F(DecisionLogTest, PathThatCannotBeWrittenIsNamed) {
  const std::string path = (folder_.path() / "none" / "decisions.csv").string();
  try {
    DecisionLog log(path);
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr(path));
  }
}

}  // namespace
}  // namespace lapis::planner
