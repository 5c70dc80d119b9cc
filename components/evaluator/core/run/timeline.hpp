#pragma once

#include <optional>
#include <string>
#include <vector>

#include "evaluator/core/run/pose_tier.hpp"

namespace lapis::evaluator {

/// The state of a run at one time stamp; members that were not measured have no value.
struct TimelineRow {
  double time_s = 0.0;
  std::optional<double> explored_volume_m3;
  std::optional<double> explored_share;
  std::optional<double> explored_share_with_margin;
  std::optional<double> path_length_m;
  std::optional<double> position_error_m;  ///< not aligned
  std::optional<double> position_sigma_m;  ///< predicted by slam: root of the sum of the variances of x, y and z
  PoseTier tier = PoseTier::kNone;
  std::string planner_state;   ///< empty without a planner
  bool is_stalled = false;     ///< in a stretch without progress, see mark_stalls
  bool is_comparable = false;  ///< the map has the grid and the session by which the run is judged; not written
};

/// Quality of slam's pose of one frame; members that were not measured have no value.
struct FrameRow {
  double time_s = 0.0;  ///< since the run's first frame
  PoseTier tier = PoseTier::kNone;
  std::optional<double> path_length_m;     ///< length of the true path so far
  std::optional<double> position_sigma_m;  ///< as in TimelineRow
  std::optional<double> position_error_m;  ///< as in TimelineRow
};

/// The file timeline.csv; cells without a value are empty.
std::string to_csv(const std::vector<TimelineRow>& rows);
/// The file frames.csv, in the same way.
std::string to_csv(const std::vector<FrameRow>& rows);

/// Marks rows within stretches of kStallWindow_s or more in which the explored share (with margin, where it is known)
/// grows by less than kStallGrowth. Rows without a share are not marked.
void mark_stalls(std::vector<TimelineRow>& rows);
inline constexpr double kStallWindow_s = 20.0, kStallGrowth = 0.0025;
/// Fraction [0, 1] of stalled time in the time until the explored share (with margin, where it is known) first reaches
/// `share`, or until the end; none without a share.
std::optional<double> stalled_share(const std::vector<TimelineRow>& rows, double share);

/// Time at which the explored share first reaches `share` [s]; none when it never does.
std::optional<double> time_to_reach(const std::vector<TimelineRow>& rows, double share);

}  // namespace lapis::evaluator
