#include "evaluator/core/run/timeline.hpp"

#include <algorithm>
#include <cstdio>

namespace lapis::evaluator {
namespace {

constexpr const char* kTimelineHeader =
    "time_s,explored_volume_m3,explored_share,explored_share_with_margin,path_length_m,position_error_m,"
    "position_sigma_m,state,planner_state,is_stalled\n";
constexpr const char* kFramesHeader = "time_s,tier,path_length_m,position_sigma_m,position_error_m\n";

std::string cell(const std::optional<double>& value) {
  if (!value) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.6f", *value);
  return text;
}

std::optional<double> share_of(const TimelineRow& row) {
  return row.explored_share_with_margin ? row.explored_share_with_margin : row.explored_share;
}

const char* state_of(PoseTier tier) {
  if (tier == PoseTier::kNone) return "LOST";
  return tier == PoseTier::kOdometry ? "DEAD_RECKONING" : "TRACKING";
}

}  // namespace

std::string to_csv(const std::vector<TimelineRow>& rows) {
  std::string text = kTimelineHeader;
  for (const TimelineRow& row : rows) {
    text += cell(row.time_s) + "," + cell(row.explored_volume_m3) + "," + cell(row.explored_share) + "," +
            cell(row.explored_share_with_margin) + "," + cell(row.path_length_m) + "," + cell(row.position_error_m) +
            "," + cell(row.position_sigma_m) + "," + state_of(row.tier) + "," + row.planner_state + "," +
            (row.is_stalled ? "1" : "0") + "\n";
  }
  return text;
}

std::string to_csv(const std::vector<FrameRow>& rows) {
  std::string text = kFramesHeader;
  for (const FrameRow& row : rows) {
    text += cell(row.time_s) + "," + name_of(row.tier) + "," + cell(row.path_length_m) + "," +
            cell(row.position_sigma_m) + "," + cell(row.position_error_m) + "\n";
  }
  return text;
}

void mark_stalls(std::vector<TimelineRow>& rows) {
  std::size_t from = 0;  // the newest row that is at least a whole window older
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i].is_stalled = false;
    if (!share_of(rows[i])) continue;
    while (from + 1 < i && rows[i].time_s - rows[from + 1].time_s >= kStallWindow_s) ++from;
    if (!share_of(rows[from]) || rows[i].time_s - rows[from].time_s < kStallWindow_s) continue;
    if (*share_of(rows[i]) - *share_of(rows[from]) >= kStallGrowth) continue;
    for (std::size_t k = from + 1; k <= i; ++k) rows[k].is_stalled = share_of(rows[k]).has_value();
  }
}

std::optional<double> stalled_share(const std::vector<TimelineRow>& rows, double share) {
  double stalled_s = 0.0, all_s = 0.0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (share_of(rows[i - 1]).value_or(0.0) >= share) break;
    all_s = rows[i].time_s - rows.front().time_s;
    stalled_s += rows[i].is_stalled ? rows[i].time_s - rows[i - 1].time_s : 0.0;
  }
  const bool is_known = std::any_of(rows.begin(), rows.end(), [](const TimelineRow& row) { return share_of(row); });
  return is_known && all_s > 0.0 ? std::optional(stalled_s / all_s) : std::nullopt;
}

std::optional<double> time_to_reach(const std::vector<TimelineRow>& rows, double share) {
  const auto has_reached = [share](const TimelineRow& row) {
    return row.explored_share && *row.explored_share >= share;
  };
  const auto first = std::find_if(rows.begin(), rows.end(), has_reached);
  return first == rows.end() ? std::nullopt : std::optional(first->time_s);
}

}  // namespace lapis::evaluator
