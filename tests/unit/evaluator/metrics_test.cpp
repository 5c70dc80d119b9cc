#include "evaluator/core/run/metrics.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "evaluator/core/run/decision_record.hpp"
#include "evaluator/core/run/timeline.hpp"

namespace lapis::evaluator {
namespace {

using nlohmann::ordered_json;
using ::testing::HasSubstr;
using ::testing::Not;

// The contract with everyone who reads run folders.
const std::vector<std::string> kKeys = {"exit_reason",
                                        "frames_total",
                                        "frames_tracked",
                                        "tier_vision_share",
                                        "tier_surfaces_share",
                                        "tier_odometry_share",
                                        "lost_share",
                                        "lost_time_s",
                                        "loop_closures",
                                        "ate_se3_rmse_m",
                                        "ate_origin_rmse_m",
                                        "ate_raw_rmse_m",
                                        "rpe_1m_rmse_m",
                                        "heading_rmse_rad",
                                        "keyframe_ate_se3_rmse_m",
                                        "keyframe_ate_origin_rmse_m",
                                        "keyframe_ate_raw_rmse_m",
                                        "correction_rmse_m",
                                        "ate_at_80_m",
                                        "ate_per_metre",
                                        "map_error_mean_m",
                                        "map_error_p95_m",
                                        "map_completeness_mean_m",
                                        "iou_top8_mean",
                                        "iou_mean",
                                        "iou_by_class",
                                        "explored_volume_m3",
                                        "explored_share",
                                        "explored_share_with_margin",
                                        "time_to_80_s",
                                        "time_to_90_s",
                                        "stalled_share",
                                        "path_length_m",
                                        "collisions",
                                        "failures",
                                        "decision_time_p50_s",
                                        "decision_time_p95_s",
                                        "real_time_factor",
                                        "duration_s",
                                        "wall_time_s",
                                        "cpu_ms_per_frame",
                                        "peak_rss_mb"};
const std::vector<std::string> kMapKeys = {"map_error_mean_m", "map_error_p95_m", "map_completeness_mean_m",
                                           "iou_top8_mean",    "iou_mean",        "iou_by_class"};

TEST(Metrics, EveryKeyIsThereAndNullUntilMeasured) {
  const auto document = ordered_json::parse(to_json(RunMetrics{}));
  for (const std::string& key : kKeys) EXPECT_TRUE(document.contains(key)) << key;
  for (const std::string& key : kMapKeys) {
    EXPECT_TRUE(document.contains("ideal_" + key));
    EXPECT_TRUE(document.contains("mesh_" + key));
  }
  for (const auto& [key, value] : document.items()) EXPECT_TRUE(value.is_null()) << key;
}

TEST(Metrics, MeasuredZeroIsZeroAndNumbersThatAreNotFiniteAreNull) {
  RunMetrics metrics;
  metrics.collisions = 0;
  metrics.lost_time_s = 0.0;
  metrics.real_time_factor = std::numeric_limits<double>::quiet_NaN();
  metrics.cpu_ms_per_frame = {{"slam", 12.5}, {"evaluator", std::nullopt}};
  const auto document = ordered_json::parse(to_json(metrics));
  EXPECT_EQ(document["collisions"], 0);
  EXPECT_EQ(document["lost_time_s"], 0.0);
  EXPECT_TRUE(document["real_time_factor"].is_null());
  EXPECT_EQ(document["cpu_ms_per_frame"]["slam"], 12.5);
  EXPECT_TRUE(document["cpu_ms_per_frame"]["evaluator"].is_null());
}

TEST(Metrics, NumbersSurviveTheDocument) {
  RunMetrics metrics;
  metrics.online.ate_se3_rmse_m = 0.1 + 0.2;
  EXPECT_EQ(ordered_json::parse(to_json(metrics))["ate_se3_rmse_m"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(to_json(metrics), to_json(metrics));
}

TEST(Metrics, TableShowsWhatIsMissing) {
  RunMetrics metrics;
  metrics.exit_reason = "finished";
  metrics.online.ate_raw_rmse_m = 0.0123;
  metrics.peak_rss_mb = {{"slam", 100.0}};
  const std::string table = format_table(metrics);
  EXPECT_THAT(table, HasSubstr("exit_reason                       finished\n"));
  EXPECT_THAT(table, HasSubstr("ate_raw_rmse_m                    0.0123\n"));
  EXPECT_THAT(table, HasSubstr("collisions                        -\n"));
  EXPECT_THAT(table, HasSubstr("peak_rss_mb.slam                  100.0000\n"));
  EXPECT_THAT(table, Not(HasSubstr("null")));
}

TEST(Metrics, TrajectoryFiguresOfADriftingWalk) {
  Trajectory reference, estimate;
  for (int i = 0; i <= 100; ++i) {
    const time::Time stamp{i * 100000000LL};
    const auto pose = [](double x) { return geometry::make_pose({x, 0, 0}, Eigen::Quaterniond::Identity()); };
    reference.push_back({stamp, pose(0.1 * i)});
    estimate.push_back({stamp, pose(0.11 * i)});
  }
  const TrajectoryFigures figures = trajectory_figures(reference, estimate);
  EXPECT_NEAR(*figures.rpe_1m_rmse_m, 0.1, 1e-9);
  EXPECT_NEAR(*figures.ate_raw_rmse_m, *figures.ate_origin_rmse_m, 1e-9);
  EXPECT_LT(*figures.ate_se3_rmse_m, *figures.ate_raw_rmse_m);
  EXPECT_NEAR(*figures.heading_rmse_rad, 0.0, 1e-9);
  EXPECT_FALSE(trajectory_figures({}, estimate).ate_raw_rmse_m);
}

TEST(Metrics, AteUpToAPathLengthIsThatOfThePosesBefore) {
  Trajectory reference, estimate;  // 1 m/s; the estimate is 1 m beside at the start, and 5 m from 3 s on
  for (int i = 0; i <= 10; ++i) {
    const auto pose = [i](double y) { return geometry::make_pose({1.0 * i, y, 0}, Eigen::Quaterniond::Identity()); };
    reference.push_back({time::Time::from_seconds(i), pose(0.0)});
    estimate.push_back({time::Time::from_seconds(i), pose(i < 3 ? 1.0 : 5.0)});
  }
  EXPECT_NEAR(*ate_raw_rmse_up_to(2.0, reference, estimate), 1.0, 1e-12);
  EXPECT_NEAR(*ate_raw_rmse_up_to(3.0, reference, estimate), std::sqrt((3.0 + 25.0) / 4.0), 1e-12);
  EXPECT_TRUE(ate_raw_rmse_up_to(10.0, reference, estimate));
  EXPECT_FALSE(ate_raw_rmse_up_to(10.1, reference, estimate));
}

TEST(Metrics, DecisionsAreCountedOnceWhateverIsReportedTwice) {
  DecisionRecord record;
  RunMetrics metrics;
  record.add({});
  record.write_to(metrics);
  EXPECT_FALSE(metrics.decisions || metrics.decision_time_p50_s);
  for (const DecisionCounts& reported : {DecisionCounts{1, 0.1, 0}, {1, 0.1, 0}, {2, 0.3, 2}, {2, 0.3, 2}})
    record.add(reported);
  record.add({1, 0.5, 0});  // a planner that was restarted
  record.add({2, 0.7, 1});
  record.write_to(metrics);
  EXPECT_EQ(metrics.decisions, 4);
  EXPECT_EQ(metrics.failures, 3);
  EXPECT_DOUBLE_EQ(*metrics.decision_time_p50_s, 0.4);
  EXPECT_DOUBLE_EQ(*metrics.decision_time_p95_s, 0.67);
}

TEST(Metrics, MapFiguresNameTheClasses) {
  const auto map = make_labelled_voxels(0.25, {{{0, 0, 0}, 1}, {{1, 0, 0}, 1}, {{2, 0, 0}, 7}});
  RunMetrics metrics;
  metrics.map = map_figures(map, map, {{1, "wall"}});
  const auto document = ordered_json::parse(to_json(metrics));
  EXPECT_EQ(document["iou_by_class"]["wall"]["iou"], 1.0);
  EXPECT_EQ(document["iou_by_class"]["wall"]["reference_voxels"], 2);
  EXPECT_EQ(document["iou_by_class"]["7"]["top8"], true);
  EXPECT_EQ(document["iou_top8_mean"], 1.0);
  EXPECT_EQ(document["map_error_mean_m"], 0.0);
  EXPECT_TRUE(document["mesh_iou_by_class"].is_null());
}

TEST(Timeline, WhatWasNotMeasuredIsEmpty) {
  TimelineRow row;
  row.time_s = 1.5;
  EXPECT_THAT(to_csv({row}), HasSubstr("stalled\n1.500000,,,,,,,LOST,,0\n"));
  row = {2.0, 10.0, 0.25, 0.5, 3.0, 0.125, 0.0625, PoseTier::kSurfaces, "EXPLORING", true, true};
  EXPECT_THAT(to_csv({row}),
              HasSubstr("\n2.000000,10.000000,0.250000,0.500000,3.000000,0.125000,0.062500,TRACKING,EXPLORING,1\n"));
  row.tier = PoseTier::kOdometry;
  EXPECT_THAT(to_csv({row}), HasSubstr(",DEAD_RECKONING,EXPLORING,1\n"));
}

TEST(Timeline, TimeToReachIsThatOfTheFirstRow) {
  std::vector<TimelineRow> rows(5);
  const std::vector<std::optional<double>> shares = {std::nullopt, 0.1, 0.8, 0.79, 0.85};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].time_s = static_cast<double>(i);
    rows[i].explored_share = shares[i];
  }
  EXPECT_EQ(time_to_reach(rows, 0.8), 2.0);
  EXPECT_EQ(time_to_reach(rows, 0.81), 4.0);
  EXPECT_FALSE(time_to_reach(rows, 0.9));
  EXPECT_FALSE(time_to_reach({}, 0.0));
}

/// A row a second with these shares, grown by so much a second.
std::vector<TimelineRow> grown(const std::vector<std::pair<int, double>>& seconds_and_growth) {
  std::vector<TimelineRow> rows(1);
  rows[0].explored_share = 0.0;
  for (const auto& [seconds, growth] : seconds_and_growth) {
    for (int i = 0; i < seconds; ++i) {
      TimelineRow row;
      row.time_s = rows.back().time_s + 1.0;
      row.explored_share = *rows.back().explored_share + growth;
      rows.push_back(row);
    }
  }
  return rows;
}

TEST(Timeline, StallsAreWholeWindowsWithoutGrowth) {
  auto rows = grown({{40, 0.01}, {30, 0.0}, {40, 0.01}, {15, 0.0}, {40, 0.01}});
  mark_stalls(rows);
  for (const TimelineRow& row : rows)
    EXPECT_EQ(row.is_stalled, row.time_s > 40.0 && row.time_s <= 70.0) << row.time_s << " s: the second is too short";
  EXPECT_DOUBLE_EQ(*stalled_share(rows, 2.0), 30.0 / 165.0);
  EXPECT_DOUBLE_EQ(*stalled_share(rows, 0.495), 30.0 / 80.0) << "what comes after half was reached does not count";
  EXPECT_DOUBLE_EQ(*stalled_share(rows, 0.295), 0.0);
  EXPECT_FALSE(stalled_share({}, 0.9));
}

TEST(Timeline, AShareWithMarginCountsWhereItIsKnownAndRowsWithoutAreNoStalls) {
  auto rows = grown({{60, 0.0}});
  for (TimelineRow& row : rows) row.explored_share_with_margin = 0.001 * row.time_s;
  mark_stalls(rows);
  EXPECT_EQ(*stalled_share(rows, 0.9), 0.0);
  for (TimelineRow& row : rows) row.explored_share = row.explored_share_with_margin = std::nullopt;
  mark_stalls(rows);
  EXPECT_TRUE(std::none_of(rows.begin(), rows.end(), [](const TimelineRow& row) { return row.is_stalled; }));
  EXPECT_FALSE(stalled_share(rows, 0.9));
}

}  // namespace
}  // namespace lapis::evaluator
