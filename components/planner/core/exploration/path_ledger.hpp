#pragma once

#include <optional>
#include <vector>

#include "common/time/time.hpp"
#include "planner/core/decision/decision.hpp"
#include "planner/core/hallucination/closed_loops.hpp"

namespace lapis::planner {

/// A path from its choice until there was none or another one was chosen.
struct DrivenPath {
  time::Time begin, end;
  CandidateKind kind = CandidateKind::kFrontier;
  double cost_m = 0.0;         ///< when it was chosen first
  double promised_nats = 0.0;  ///< by Decision::promised when it was chosen first
  double driven_nats = 0.0;    ///< of these, by what was driven of it
  double gained_nats = 0.0;    ///< by the map from begin to end
  /// Of the log-determinant of the pose graph by loop closures: expected when the path was chosen first, and what those
  /// that were closed from begin to end add. Nothing where nobody asks for the spectrum, or without a graph.
  std::optional<double> promised_loop_gain = {}, loop_gain = {};

  bool operator==(const DrivenPath&) const = default;
};

/// What the robot knows.
struct Learnt {
  double map_nats = 0.0;                 ///< MapInformation::nats()
  const AnalysedGraph* graph = nullptr;  ///< null: none
};

/// Compares what paths promised with what the map and the pose graph gained while they were driven. A path is the same
/// as long as its goal stays near to what it was at first: it has no promise of what lies beyond.
class PathLedger {
 public:
  /// @param radius_m between the goals of one path
  explicit PathLedger(double radius_m) : radius_m_(radius_m) {}

  /// Takes note of the choice that is being driven to, or that there is none. What ended by that, if anything did.
  /// @param decision with a choice; null: nothing is driven to
  std::optional<DrivenPath> note(const Decision* decision, const Learnt& learnt, const Pose2& robot, time::Time now);

 private:
  bool is_same(const Pose2& goal) const;
  void begin(const Decision& decision, const Learnt& learnt, time::Time now);
  std::optional<DrivenPath> end(const Learnt& learnt, const Pose2& robot, time::Time now);

  std::optional<DrivenPath> path_;
  std::vector<PromisedView> promised_;
  Pose2 goal_;
  double nats_at_begin_ = 0.0;
  std::vector<LoopName> loops_at_begin_;
  double radius_m_;
};

}  // namespace lapis::planner
