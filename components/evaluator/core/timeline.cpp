#include "evaluator/core/timeline.hpp"

#include <algorithm>
#include <cstdio>

namespace lapis::evaluator {
namespace {

constexpr const char* kTimelineHeader =
    "time_s,explored_volume_m3,explored_share,path_length_m,position_error_m,position_sigma_m,state,planner_state\n";
constexpr const char* kFramesHeader = "time_s,tier,path_length_m,position_sigma_m,position_error_m\n";

std::string cell(const std::optional<double>& value) {
  if (!value) return "";
  char text[40];
  std::snprintf(text, sizeof text, "%.6f", *value);
  return text;
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
            cell(row.path_length_m) + "," + cell(row.position_error_m) + "," + cell(row.position_sigma_m) + "," +
            state_of(row.tier) + "," + row.planner_state + "\n";
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

std::optional<double> time_to_reach(const std::vector<TimelineRow>& rows, double share) {
  const auto has_reached = [share](const TimelineRow& row) {
    return row.explored_share && *row.explored_share >= share;
  };
  const auto first = std::find_if(rows.begin(), rows.end(), has_reached);
  return first == rows.end() ? std::nullopt : std::optional(first->time_s);
}

}  // namespace lapis::evaluator
