#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "planner/core/hallucination/hallucination.hpp"
#include "planner/core/space/viewpoints.hpp"

namespace lapis::planner {

enum class CandidateKind {
  kFrontier,     ///< the best path to a place from which a frontier is seen
  kAlternative,  ///< another path to such a place
  kCloserLook,   ///< the best path to a place near a frontier that cannot be seen from there, as the map is
  kTracked,      ///< the best path to a place at which slam tracked, while it does not
  kGap,          ///< the best path to a view of what no frontier asks for
  kRevisit,      ///< the best path to an old key-frame
};

/// Whether it shows a frontier.
inline bool is_of_frontier(CandidateKind kind) { return kind < CandidateKind::kTracked; }

/// "frontier" and so on, as in decisions.csv.
const char* name_of(CandidateKind kind);

/// Loop closure that a path may bring.
struct ExpectedLoop {
  Eigen::Vector3d node_map{0, 0, 0};      ///< hallucinated key-frame that sees most of the place [m]
  Eigen::Vector3d keyframe_map{0, 0, 0};  ///< of the place [m]
  double probability = 0.0;
};

/// What is known about a path; zero what no method asks for. All information in nats.
struct PathValue {
  static constexpr double kLeastCost_m = 0.25;

  double cost_m = 0.0;  ///< length and turning; nearness shapes the path only (set_path in candidate_paths.cpp)
  double path_information = 0.0;      ///< of its views, each cell once
  double goal_information = 0.0;      ///< of the last view, every ray for itself
  double loop_gain = 0.0;             ///< expected change of the log-determinant by loops, saturated
  double optimality = 0.0;            ///< of the graph with the path, all its nodes in it; 1: no graph to judge
  double fixed_n_d_optimality = 0.0;  ///< from the expected change of the log-determinant at equal number of nodes
  int tour_place = 0;                 ///< of the goal in TARE's tour, from 1
  double unknown_share = 0.0;         ///< of the cells around what is looked at, in [0, 1]

  /// The cost, but that of a voxel for a shorter path.
  double paid_m() const { return std::max(cost_m, kLeastCost_m); }
};

/// A path to a place from which there is something to see.
struct Candidate {
  CandidateKind kind = CandidateKind::kFrontier;
  std::uint32_t frontier = 0;  ///< 0: a place, not a frontier
  Pose2 goal;
  Eigen::Vector2d target_map{0, 0};  ///< what is looked at from there, or the place that is revisited [m]
  std::vector<Eigen::Vector2d>
      points;               ///< corners of the path from the robot to the goal [m]; empty when there is none
  std::vector<Pose2> path;  ///< views along it, but for those while it turns
  PathValue value;
  ExpectedGain gain;
  std::vector<Eigen::Vector3d> nodes_map;  ///< hallucinated key-frames [m]
  std::vector<ExpectedLoop> loops;         ///< to old places that the path would see again
  double utility = 0.0;                    ///< of the method
  Rejection rejection = Rejection::kNone;

  /// It is judged.
  bool is_open() const { return rejection == Rejection::kNone; }
};

}  // namespace lapis::planner
