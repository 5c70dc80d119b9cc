#pragma once

#include <optional>
#include <vector>

#include "common/time/time.hpp"
#include "planner/core/decision/decision.hpp"
#include "planner/core/hallucination/closed_loops.hpp"

namespace lapis::planner {

/// A path, from its choice until another one was chosen or none was left.
struct DrivenPath {
  time::Time begin, end;
  CandidateKind kind = CandidateKind::kFrontier;
  double cost_m = 0.0;         ///< at the first choice of the path
  double promised_nats = 0.0;  ///< of Decision::promised at the first choice of the path
  double driven_nats = 0.0;    ///< part of promised_nats that belongs to the driven part of the path
  double gained_nats = 0.0;    ///< by the map from begin to end
  /// Change of the pose graph's log-determinant by loop closures: the expectation at the first choice of the path, and
  /// the contribution of the loops that were closed from begin to end. Empty when no method asks for the spectrum, or
  /// without a graph.
  std::optional<double> promised_loop_gain = {}, loop_gain = {};

  bool operator==(const DrivenPath&) const = default;
};

/// What the robot knows at an instant.
struct Learnt {
  double map_nats = 0.0;                 ///< MapInformation::nats()
  const AnalysedGraph* graph = nullptr;  ///< null when there is no graph
};

/// Compares what paths promised with what the map and the pose graph gained while the robot drove them. A path remains
/// the same while its goal stays near to the first one; its promise covers nothing beyond that goal.
class PathLedger {
 public:
  /// @param radius_m largest distance between the goals of one path
  explicit PathLedger(double radius_m) : radius_m_(radius_m) {}

  /// Notes the choice that the robot is driving to, or that there is none. Returns the path that ended by this, if any.
  /// @param decision with a choice; null: the robot is driving to nothing
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
