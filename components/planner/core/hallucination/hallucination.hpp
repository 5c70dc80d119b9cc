#pragma once

#include <span>
#include <vector>

#include "planner/core/hallucination/landmark_index.hpp"
#include "planner/core/spectral/candidate_gain.hpp"

namespace lapis::planner {

struct HallucinationConfig {
  CovisibilityConfig covisibility;
  /// Landmarks seen again of which a loop closure is impossible (or fewer), and as sure as it gets (or more); its
  /// probability is linear in between. 1 <= impossible < certain.
  int impossible_landmarks = 10, certain_landmarks = 100;
  double max_probability = 0.6;     ///< of a loop closure, however many landmarks are seen again
  double min_loop_path_m = 5.0;     ///< path_between() along the graph; nearer key-frames make no loop
  double place_radius_m = 2.0;      ///< key-frames nearer to each other are one place
  double revisit_spacing_m = 20.0;  ///< path after a loop closure before its place counts again
  int max_places = 6;               ///< of a path; the most probable ones
  double loop_weight = 0.0;         ///< of a loop's edge, in weights of a metre of odometry; 0: as in the graph
};

/// Of a loop closure with a place of which so many landmarks are seen again.
double loop_probability(int landmarks, const HallucinationConfig& config);

/// Old place that a path would see again.
struct Place {
  int keyframe = 0;          ///< node of the AnalysedGraph
  int node = 0;              ///< of the path
  int landmarks = 0;         ///< seen again
  double probability = 0.0;  ///< of a loop closure
};

/// What the pose graph would gain by driving a path.
struct Hallucination {
  HallucinatedGraph graph;    ///< loop edges have the weight of real ones, whatever their probability
  std::vector<Place> places;  ///< index = HallucinatedEdge::place
};

/// Nodes at camera poses along a path, joined to the newest key-frame and to each other by odometry whose weight falls
/// with distance as that of the running graph does; and to old places by one loop edge each. A node counts with the
/// place of which it sees most (slam closes a key-frame with one place), and of the nodes that count with a place the
/// one that sees most of it makes the edge. Deterministic. At least one pose.
Hallucination hallucinate(const AnalysedGraph& graph, const LandmarkIndex& landmarks, const InformationField& field,
                          const geometry::PinholeCamera& camera, std::span<const geometry::Pose> T_map_cameras,
                          const HallucinationConfig& config);

/// Expectations over which of the places close, each with its probability and independently.
struct ExpectedGain {
  /// Of the log-determinant by loops, counted only as far as they bring the sigma of the path's end down to the limit.
  double saturated_loop_gain = 0.0;
  /// Of the log-determinant at equal number of nodes.
  double fixed_n_change = 0.0;
  double end_sigma_without_loops_m = 0.0;  ///< of the position at the path's end, each axis
  double end_sigma_m = 0.0;                ///< the same, expected
  double loop_gain = 0.0;                  ///< of the log-determinant by loops, all of it
};

/// @param sigma_limit_m what is more exact than this is of no use to the map, > 0. The error names a wrong edge.
std::variant<ExpectedGain, GraphError> expect_gain(const AnalysedGraph& graph, const Hallucination& path,
                                                   double sigma_limit_m);

/// Optimality with all nodes and loop edges, these with probability times weight, by the graph's criterion: the paper's
/// form, which is too optimistic (E ln det <= ln det E). D is a low-rank update, anything else an analysis of the whole
/// graph with the path.
std::variant<double, GraphError> literal_optimality(const AnalysedGraph& graph, const Hallucination& path);

}  // namespace lapis::planner
