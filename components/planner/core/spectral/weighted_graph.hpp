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

/// Which mean of the eigenvalues of an information matrix is taken, by the exponent p of Zhang et al. 2024, eq. 20-23.
enum class Criterion {
  kD,  ///< p -> 0: geometric mean
  kA,  ///< p = -1: harmonic mean
  kT,  ///< p = 1: arithmetic mean
  kE,  ///< p -> -infinity: smallest eigenvalue
};

/// Information of a measurement, up to 6x6, for example of a relative pose in the tangent space of SE(3)
/// [1/m^2, 1/rad^2] or of a position [1/m^2].
using Information = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

/// Weight of an edge: the mean of the eigenvalues of its information. Empty when the matrix is not finite, symmetric
/// and positive definite. Only kD does not depend on the frame of the tangent space.
std::optional<double> edge_weight(const Information& information, Criterion criterion);

/// Why a graph cannot be analysed. The message is one of a few sentences, because users count them.
struct GraphError {
  std::string message;
};

/// Index of a node in a container.
inline std::size_t index(int node) { return static_cast<std::size_t>(node); }

struct WeightedEdge {
  int a = 0, b = 0;
  double weight = 0.0;
};

/// What is wrong with an edge between nodes 0..node_count-1; empty when nothing is.
std::optional<GraphError> edge_error(int node_count, const WeightedEdge& edge);

/// A connected graph of nodes 0..n-1 with positive weights.
class WeightedGraph {
 public:
  /// The weights of parallel edges are added. The error says what is wrong: there is no node, an edge joins a node to
  /// itself or names a node that does not exist, a weight is not positive and finite, or a node is not connected to
  /// node 0.
  static std::variant<WeightedGraph, GraphError> make(int node_count, std::vector<WeightedEdge> edges);

  int node_count() const { return node_count_; }
  /// a < b, sorted, each pair once.
  const std::vector<WeightedEdge>& edges() const { return edges_; }

 private:
  WeightedGraph(int node_count, std::vector<WeightedEdge> edges) : node_count_(node_count), edges_(std::move(edges)) {}

  int node_count_ = 0;
  std::vector<WeightedEdge> edges_;
};

/// A measurement between two key-frames.
struct KeyframeEdge {
  std::uint64_t from = 0, to = 0;
  Information information;
  bool is_loop_closure = false;
};

struct KeyframeGraph {
  WeightedGraph graph;
  std::vector<std::uint64_t> keyframes;  ///< id of each node, in ascending order

  /// Node of a key-frame; empty when the key-frame is not in this component.
  std::optional<int> node_of(std::uint64_t keyframe) const;
};

/// The part of the pose graph that is connected to `keyframe` (the robot's newest); other parts are out of date. Fails
/// when an edge of that part has no weight.
std::variant<KeyframeGraph, GraphError> component_of(std::uint64_t keyframe, std::span<const KeyframeEdge> edges,
                                                     Criterion criterion);

}  // namespace lapis::planner
