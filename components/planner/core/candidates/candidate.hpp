#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planner/core/hallucination/hallucination.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

enum class CandidateKind {
  kFrontier,     ///< the cheapest path to a place from which a frontier is visible
  kAlternative,  ///< another path to such a place
  kCloserLook,   ///< the cheapest path to a place near a frontier that the current map hides from there
  kTracked,      ///< the cheapest path to a place at which slam tracked, proposed while slam does not track
  kGap,          ///< the cheapest path to a view of unobserved voxels that no frontier shows
  kRevisit,      ///< the cheapest path to an old key-frame
};

/// True when a candidate of this kind is a view of a frontier.
inline bool is_of_frontier(CandidateKind kind) { return kind < CandidateKind::kTracked; }

/// Name of the kind in decisions.csv, for example "frontier".
const char* name_of(CandidateKind kind);

/// A loop closure that driving a path may bring.
struct ExpectedLoop {
  Eigen::Vector3d node_map{0, 0, 0};      ///< hallucinated key-frame that sees most of the old place [m]
  Eigen::Vector3d keyframe_map{0, 0, 0};  ///< key-frame of the old place [m]
  double probability = 0.0;
};

/// The terms of a path's value; terms that no method asks for are zero. All information is in nats.
struct PathValue {
  static constexpr double kLeastCost_m = 0.25;

  double cost_m = 0.0;  ///< length plus cost of turning; the nearness of obstacles affects only the path's shape
  double path_information = 0.0;  ///< of all views along the path; each cell counts once
  double goal_information = 0.0;  ///< of the last view; every ray counts by itself
  double loop_gain = 0.0;         ///< expected change of the log-determinant by loop closures, saturated
  /// Optimality of the pose graph extended by all nodes of the path; 1 when there is no graph to judge.
  double optimality = 0.0;
  /// D-optimality from the expected change of the log-determinant at an equal number of nodes.
  double fixed_n_d_optimality = 0.0;
  int tour_place = 0;            ///< position of the goal in TARE's tour, counted from 1
  double unknown_share = 0.0;    ///< share of unknown cells around the target, in [0, 1]
  double surviving_share = 1.0;  ///< of what the path's views show, in the map (MapWorth)
  double secured_nats = 0.0;     ///< what the path's loops are expected to add to the worth of the map

  /// The cost [m], at least kLeastCost_m, so that very short paths do not get an unbounded utility.
  double paid_m() const { return std::max(cost_m, kLeastCost_m); }
};

/// A path to a place with a view, and what is known about it.
struct Candidate {
  CandidateKind kind = CandidateKind::kFrontier;
  std::uint32_t frontier = 0;  ///< 0: the candidate does not belong to a frontier
  Pose2 goal;
  Eigen::Vector2d target_map{0, 0};  ///< what is viewed from the goal, or the old place that is revisited [m]
  std::vector<Eigen::Vector2d>
      points;               ///< corners of the path from the robot to the goal [m]; empty when there is no path
  std::vector<Pose2> path;  ///< views along the path, without those taken while the robot turns on the spot
  PathValue value;
  ExpectedGain gain;
  std::vector<Eigen::Vector3d> nodes_map;  ///< hallucinated key-frames [m]
  std::vector<ExpectedLoop> loops;         ///< with old places that the path would see again
  double utility = 0.0;                    ///< by the method that decides
  Rejection rejection = Rejection::kNone;

  /// True when the candidate is not rejected, so that the method judges it.
  bool is_open() const { return rejection == Rejection::kNone; }
};

}  // namespace lapis::planner
