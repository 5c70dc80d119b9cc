#pragma once

#include <optional>

#include "common/time/time.hpp"
#include "planner/core/decision/decision.hpp"

namespace lapis::planner {

/// A path from its choice until there was none or another target was chosen.
struct DrivenPath {
  time::Time begin, end;
  CandidateKind kind = CandidateKind::kFrontier;
  double cost_m = 0.0;         ///< when it was chosen first
  double rest_m = 0.0;         ///< cost of what was left when it was judged last
  double promised_nats = 0.0;  ///< Candidate::value.path_information when it was chosen first
  double rest_nats = 0.0;      ///< the same when it was judged last
  double gained_nats = 0.0;    ///< by the map from begin to end

  bool operator==(const DrivenPath&) const = default;
};

/// Compares what paths promised with what the map gained while they were driven. A path is the same as long as its
/// target stays within a radius of where it was at first: it has no promise of what lies beyond.
class PathLedger {
 public:
  /// @param radius_m between the targets of one path
  explicit PathLedger(double radius_m) : radius_m_(radius_m) {}

  /// Takes note of a choice that is being driven to, or that there is none. What ended by that, if anything did.
  /// @param map_nats MapInformation::nats() now
  std::optional<DrivenPath> note(const Candidate* chosen, double map_nats, time::Time now);

 private:
  std::optional<DrivenPath> path_;
  Eigen::Vector2d target_map_{0, 0};
  double nats_at_begin_ = 0.0;
  double radius_m_;
};

}  // namespace lapis::planner
