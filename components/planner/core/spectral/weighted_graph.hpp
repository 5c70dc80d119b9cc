#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

namespace lapis::planner {

/// Mean of the eigenvalues of an information matrix, as the exponent p of Zhang et al. 2024, eq. 20-23.
enum class Criterion {
  kD,  ///< p -> 0: geometric mean
  kA,  ///< p = -1: harmonic mean
  kT,  ///< p = 1: arithmetic mean
  kE,  ///< p -> -infinity: the smallest
};

/// Information of a measurement, up to 6x6: of a relative pose in the tangent of SE(3) [1/m^2, 1/rad^2], of a
/// position...
using Information = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

/// Weight of an edge: the mean of the eigenvalues of its information. Nothing where the matrix is not finite, symmetric
/// and positive definite. Only kD does not depend on the frame of the tangent.
std::optional<double> edge_weight(const Information& information, Criterion criterion);

/// Why a graph cannot be analysed, in one of a few sentences: users count them.
struct GraphError {
  std::string message;
};

/// Of a node, in a container.
inline std::size_t index(int node) { return static_cast<std::size_t>(node); }

struct WeightedEdge {
  int a = 0, b = 0;
  double weight = 0.0;
};

/// What is wrong with an edge between nodes 0..node_count-1, if anything.
std::optional<GraphError> edge_error(int node_count, const WeightedEdge& edge);

/// Connected graph of nodes 0..n-1 with positive weights.
class WeightedGraph {
 public:
  /// Parallel edges add. The error names what is wrong: no node, an edge of a node to itself or to none, a weight that
  /// is not positive and finite, a node without connection to node 0.
  static std::variant<WeightedGraph, GraphError> make(int node_count, std::vector<WeightedEdge> edges);

  int node_count() const { return node_count_; }
  /// a < b, sorted, each pair once.
  const std::vector<WeightedEdge>& edges() const { return edges_; }

 private:
  WeightedGraph(int node_count, std::vector<WeightedEdge> edges) : node_count_(node_count), edges_(std::move(edges)) {}

  int node_count_ = 0;
  std::vector<WeightedEdge> edges_;
};

/// Measurement between two key-frames.
struct KeyframeEdge {
  std::uint64_t from = 0, to = 0;
  Information information;
  bool is_loop_closure = false;
};

struct KeyframeGraph {
  WeightedGraph graph;
  std::vector<std::uint64_t> keyframes;  ///< id of each node, ascending

  /// Nothing for a key-frame outside of the component.
  std::optional<int> node_of(std::uint64_t keyframe) const;
};

/// The part of the pose graph that hangs together with `keyframe` (the robot's newest): stale parts do not count.
/// Fails where an edge of that part has no weight.
std::variant<KeyframeGraph, GraphError> component_of(std::uint64_t keyframe, std::span<const KeyframeEdge> edges,
                                                     Criterion criterion);

}  // namespace lapis::planner
