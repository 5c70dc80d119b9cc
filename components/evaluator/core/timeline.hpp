#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lapis::evaluator {

/// The state of a run at one time of its stamps; what was not measured has no value.
struct TimelineRow {
  double time_s = 0.0;
  std::optional<double> explored_volume_m3;
  std::optional<double> explored_share;
  std::optional<double> path_length_m;
  std::optional<double> position_error_m;  ///< not aligned
  std::optional<double> position_sigma_m;  ///< as slam predicts it: root of the variances' sum over x, y, z
  bool is_tracking = false;
  std::string planner_state;   ///< empty without a planner
  bool is_comparable = false;  ///< the map has the grid and the session that the run is judged by; not written
};

/// The file timeline.csv; cells without a value are empty.
std::string to_csv(const std::vector<TimelineRow>& rows);

/// When the share of the explorable volume first reached `share` [s]; none when it never did.
std::optional<double> time_to_reach(const std::vector<TimelineRow>& rows, double share);

}  // namespace lapis::evaluator
