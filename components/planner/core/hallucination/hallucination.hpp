#pragma once

#include <span>
#include <vector>

#include "planner/core/hallucination/landmark_index.hpp"
#include "planner/core/spectral/candidate_gain.hpp"

namespace lapis::planner {

struct HallucinationConfig {
  CovisibilityConfig covisibility;
  /// Numbers of landmarks seen again: with `impossible_landmarks` or fewer, the probability of a loop closure is 0;
  /// with `certain_landmarks` or more, it is max_probability; in between it is linear. 1 <= impossible < certain.
  int impossible_landmarks = 10, certain_landmarks = 100;
  double max_probability = 0.6;     ///< of a loop closure, however many landmarks are seen again
  double min_loop_path_m = 5.0;     ///< path_between() along the graph; nearer key-frames close no loop
  double place_radius_m = 2.0;      ///< key-frames that are nearer to each other count as one place
  double revisit_spacing_m = 20.0;  ///< path after a loop closure until its place counts again
  int max_places = 6;               ///< largest number of places of a path: the most probable ones
  /// Weight of a loop edge, in weights of 1 m of odometry; 0: AnalysedGraph::loop_weight.
  double loop_weight = 0.0;
};

/// Probability of a loop closure with a place of which this many landmarks are seen again.
double loop_probability(int landmarks, const HallucinationConfig& config);

/// An old place that a path would see again.
struct Place {
  int keyframe = 0;          ///< node of the AnalysedGraph
  int node = 0;              ///< index of the path's node, from 0
  int landmarks = 0;         ///< number of landmarks seen again
  double probability = 0.0;  ///< of a loop closure
};

/// The nodes and edges that driving a path would add to the pose graph.
struct Hallucination {
  HallucinatedGraph graph;    ///< loop edges have the full weight, whatever their probability
  std::vector<Place> places;  ///< indexed by HallucinatedEdge::place
};

/// Adds nodes at camera poses along a path. Odometry edges join them to the newest key-frame and to each other; their
/// weight decreases with distance as in the real graph. One loop edge joins the path to each old place. A node counts
/// for the place of which it sees most landmarks, because slam closes a key-frame with one place only; of the nodes
/// that count for a place, the one that sees most of it gets the edge. Deterministic.
/// @param T_map_cameras at least one pose
Hallucination hallucinate(const AnalysedGraph& graph, const LandmarkIndex& landmarks, const InformationField& field,
                          const geometry::PinholeCamera& camera, std::span<const geometry::Pose> T_map_cameras,
                          const HallucinationConfig& config);

/// Expectations over the sets of places that close; each place closes independently with its probability.
struct ExpectedGain {
  /// Change of the log-determinant by loop closures, counted only until the standard deviation at the path's end is at
  /// the limit.
  double saturated_loop_gain = 0.0;
  /// Change of the log-determinant at an equal number of nodes.
  double fixed_n_change = 0.0;
  double end_sigma_without_loops_m = 0.0;  ///< standard deviation of the position at the path's end, per axis
  double end_sigma_m = 0.0;                ///< the same, expected, with loop closures
  double loop_gain = 0.0;                  ///< change of the log-determinant by loop closures, without the limit
};

/// What the pose graph is expected to gain by a path. The error says what is wrong with an edge.
/// @param sigma_limit_m standard deviation, > 0, below which the map does not profit from a more accurate position
std::variant<ExpectedGain, GraphError> expect_gain(const AnalysedGraph& graph, const Hallucination& path,
                                                   double sigma_limit_m);

/// Optimality, by the graph's criterion, with all nodes and loop edges of the path; the weight of a loop edge is
/// multiplied by its probability. This is the paper's form, which is too optimistic because E ln det <= ln det E. kD is
/// a low-rank update; the other criteria analyse the whole graph with the path.
std::variant<double, GraphError> literal_optimality(const AnalysedGraph& graph, const Hallucination& path);

}  // namespace lapis::planner
