#pragma once

#include <cstdint>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "planner/core/spectral/laplacian_factor.hpp"
#include "planner/core/spectral/weighted_graph.hpp"

namespace lapis::planner {

/// Set of places, one bit each: the loop edges to one place are one event, they all come or none does.
using PlaceSet = std::uint64_t;
inline constexpr PlaceSet kNoPlace = 0, kEveryPlace = ~PlaceSet{0};
inline constexpr int kMaxPlaces = 64;
constexpr PlaceSet only_place(int place) { return PlaceSet{1} << place; }

/// Edge that a candidate path would add.
struct HallucinatedEdge {
  static constexpr int kCertain = -1;  ///< place of edges that come in any case: odometry, covisibility
  WeightedEdge edge;
  int place = kCertain;  ///< 0..kMaxPlaces-1 of a loop edge
};

/// What a candidate path would add to a graph of n nodes: nodes n, n+1, ..., each connected to the graph by certain
/// edges, and edges among them and to old nodes.
struct HallucinatedGraph {
  int node_count = 0;
  std::vector<HallucinatedEdge> edges;
};

/// What a candidate would change in the log-determinant of the reduced Laplacian, exact, by elimination of the new
/// nodes (method: ln det A' = ln det C + ln det A + ln det(I + M (A^-1)_ss)). Costs one sparse column per old node that
/// is touched; any set of places afterwards only small dense matrices.
class CandidateGain {
 public:
  /// The error names an edge that is wrong, or new nodes without certain connection to the graph.
  static std::variant<CandidateGain, GraphError> make(const LaplacianFactor& factor,
                                                      const HallucinatedGraph& candidate);

  /// ln S of the graph with the new nodes less ln S of the graph without: compares graphs of different size.
  double log_trees_change(PlaceSet places) const { return certain_change_ + loop_gain(places); }
  /// D-optimality of the graph with the new nodes.
  double d_optimality(PlaceSet places) const;
  /// What the loop edges to `places` add, with the new nodes in both graphs: information on the whole trajectory, past
  /// and hallucinated. 0 without places.
  double loop_gain(PlaceSet places) const;
  /// The same for the old nodes alone (Schur complement of the new ones), and of the certain edges, too: 0 where one
  /// old node is touched.
  double fixed_n_change(PlaceSet places) const;
  /// Effective resistance between a new node (n, n+1, ...) and the anchor, as LaplacianFactor::covariance.
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
  double certain_change_ = 0.0;  // of ln S by the new nodes and the certain edges
  Eigen::MatrixXd new_block_;    // of the Laplacian with the certain edges
  Eigen::MatrixXd covariance_;   // with the certain edges, of the new nodes and then the old ones that are touched
  std::vector<LoopEdge> loops_;
};

}  // namespace lapis::planner
