#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "planner/core/spectral/laplacian_factor.hpp"
#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// Set of places, one bit each. The loop edges to one place are one event: either all of them exist or none does.
using PlaceSet = std::uint64_t;
inline constexpr PlaceSet kNoPlace = 0, kEveryPlace = ~PlaceSet{0};
inline constexpr int kMaxPlaces = 64;
constexpr PlaceSet only_place(int place) { return PlaceSet{1} << place; }

/// An edge that a candidate path would add.
struct HallucinatedEdge {
  static constexpr int kCertain = -1;  ///< place of edges that exist in any case: odometry, covisibility
  WeightedEdge edge;
  int place = kCertain;  ///< of a loop edge: 0..kMaxPlaces-1
};

/// What a candidate path would add to a graph of n nodes: nodes n, n+1, ..., each connected to the graph by certain
/// edges, and edges among them and to old nodes.
struct HallucinatedGraph {
  int node_count = 0;
  std::vector<HallucinatedEdge> edges;
};

/// Exact change of the log-determinant of the reduced Laplacian by a candidate, computed by elimination of the new
/// nodes: ln det A' = ln det C + ln det A + ln det(I + M (A^-1)_ss). The cost is one sparse column per old node that
/// edges touch; after that, each set of places needs only small dense matrices.
class CandidateGain {
 public:
  /// The error says what is wrong with an edge, or that new nodes have no certain connection to the graph.
  static std::variant<CandidateGain, GraphError> make(const LaplacianFactor& factor,
                                                      const HallucinatedGraph& candidate);

  /// ln S of the graph with the new nodes minus ln S of the graph without them. The two graphs differ in size.
  double log_trees_change(PlaceSet places) const { return certain_change_ + loop_gain(places); }
  /// D-optimality of the graph with the new nodes.
  double d_optimality(PlaceSet places) const;
  /// Contribution of the loop edges to `places`, with the new nodes in both graphs: information on the whole
  /// trajectory, past and hallucinated. 0 without places.
  double loop_gain(PlaceSet places) const;
  /// The change for the old nodes alone (Schur complement of the new ones), by the certain edges and by the loop edges
  /// to `places`; 0 when only one old node is touched.
  double fixed_n_change(PlaceSet places) const;
  /// Effective resistance between a new node (n, n+1, ...) and the anchor; see LaplacianFactor::covariance.
  double variance(int new_node, PlaceSet places) const;

 private:
  CandidateGain() = default;

  struct LoopEdge {
    Eigen::Index a = 0, b = 0;  // rows of covariance_
    double weight = 0.0;
    int place = 0;
  };

  bool add_certain(const Eigen::MatrixXd& certain, const Eigen::MatrixXd& G);
  std::vector<LoopEdge> loops_to(PlaceSet places) const;
  Eigen::MatrixXd loop_system(const std::vector<LoopEdge>& loops) const;

  int graph_nodes_ = 0, new_nodes_ = 0;
  double graph_log_trees_ = 0.0;
  double certain_change_ = 0.0;  // change of ln S by the new nodes and the certain edges
  Eigen::MatrixXd new_block_;    // block of the new nodes in the Laplacian with the certain edges
  Eigen::MatrixXd covariance_;   // with the certain edges; rows: the new nodes, then the old nodes that edges touch
  std::vector<LoopEdge> loops_;
};

}  // namespace lapis::planner
