#include "planner/core/hallucination/analysed_graph.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <string>
#include <utility>

#include <Eigen/LU>

namespace lapis::planner {
namespace {

constexpr double kLeastEdgeLength_m = 0.02;     // least length of an edge whose weight is scaled by its length
constexpr double kFirstLoopLength_m = 0.5;      // without loops, one weighs as much as an odometry edge of this length
constexpr std::size_t kNewestNeighbours = 100;  // number of key-frame pairs from which odometry is calibrated

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::optional<std::vector<Keyframe>> select(std::span<const Keyframe> keyframes, std::span<const std::uint64_t> ids) {
  std::vector<Keyframe> selected;
  auto next = keyframes.begin();
  for (const std::uint64_t id : ids) {
    while (next != keyframes.end() && next->id < id) ++next;
    if (next == keyframes.end() || next->id != id) return std::nullopt;
    selected.push_back(*next);
  }
  return selected;
}

double edge_length_m(const std::vector<Keyframe>& keyframes, int a, int b) {
  return path_between(keyframes[index(a)].T_map_camera, keyframes[index(b)].T_map_camera);
}

// Dijkstra's algorithm.
std::vector<double> path_lengths_from(int root, const WeightedGraph& graph, const std::vector<Keyframe>& keyframes) {
  std::vector<std::vector<std::pair<int, double>>> neighbours(keyframes.size());
  for (const WeightedEdge& edge : graph.edges()) {
    const double length = edge_length_m(keyframes, edge.a, edge.b);
    neighbours[index(edge.a)].emplace_back(edge.b, length);
    neighbours[index(edge.b)].emplace_back(edge.a, length);
  }
  std::vector<double> lengths(keyframes.size(), std::numeric_limits<double>::infinity());
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  lengths[index(root)] = 0.0;
  open.emplace(0.0, root);
  while (!open.empty()) {
    const auto [so_far, node] = open.top();
    open.pop();
    if (so_far > lengths[index(node)]) continue;
    for (const auto& [neighbour, length] : neighbours[index(node)]) {
      if (so_far + length >= lengths[index(neighbour)]) continue;
      lengths[index(neighbour)] = so_far + length;
      open.emplace(so_far + length, neighbour);
    }
  }
  return lengths;
}

std::vector<double> travelled(const std::vector<Keyframe>& keyframes) {
  std::vector<double> sums{0.0};
  for (int i = 1; i < static_cast<int>(keyframes.size()); ++i)
    sums.push_back(sums.back() + edge_length_m(keyframes, i - 1, i));
  return sums;
}

// The effective resistance between neighbours accounts for every path through the graph, so no edges have to be chosen.
double calibrate_odometry(const LaplacianFactor& factor, const std::vector<Keyframe>& keyframes) {
  std::vector<double> values;
  const std::size_t first = keyframes.size() - std::min(keyframes.size() - 1, kNewestNeighbours);
  for (std::size_t i = first; i < keyframes.size(); ++i) {
    const int b = static_cast<int>(i), a = b - 1;
    const Eigen::MatrixXd covariance = factor.covariance(std::array{a, b});
    const double resistance = covariance(0, 0) + covariance(1, 1) - 2.0 * covariance(0, 1);
    values.push_back(std::max(edge_length_m(keyframes, a, b), kLeastEdgeLength_m) / resistance);
  }
  return median(std::move(values));
}

double variance_of_edges(std::span<const KeyframeEdge> edges, Criterion criterion) {
  std::vector<double> values;
  for (const KeyframeEdge& edge : edges) {
    const auto weight = edge_weight(edge.information, criterion);
    if (!weight) continue;  // the edge belongs to another part of the graph
    const geometry::Matrix6d covariance = edge.information.inverse();
    values.push_back(*weight * covariance.topLeftCorner<3, 3>().trace() / 3.0);
  }
  return median(std::move(values));
}

double newest_resistance(const LaplacianFactor& factor) {
  return factor.covariance(std::array{factor.node_count() - 1})(0, 0);
}

std::vector<LoopClosure> loops_of(const AnalysedGraph& graph, std::span<const KeyframeEdge> edges,
                                  Criterion criterion) {
  std::vector<LoopClosure> loops;
  for (const KeyframeEdge& edge : edges) {
    const auto a = graph.node_of(edge.from), b = graph.node_of(edge.to);
    if (!edge.is_loop_closure || !a || !b) continue;
    loops.push_back({std::min(*a, *b), std::max(*a, *b), *edge_weight(edge.information, criterion)});
  }
  return loops;
}

double calibrate_loops(const AnalysedGraph& graph) {
  if (graph.loops.empty()) return graph.odometry_weight_metres / kFirstLoopLength_m;
  std::vector<double> weights;
  for (const LoopClosure& loop : graph.loops) weights.push_back(loop.weight);
  return median(std::move(weights));
}

}  // namespace

double path_between(const geometry::Pose& a, const geometry::Pose& b) {
  const Eigen::Matrix3d R = a.linear().transpose() * b.linear();
  return (a.translation() - b.translation()).norm() + kMetresPerRadian * geometry::rotation_angle(R);
}

std::optional<int> AnalysedGraph::node_of(std::uint64_t keyframe) const {
  const auto found = std::lower_bound(keyframes.begin(), keyframes.end(), keyframe,
                                      [](const Keyframe& k, std::uint64_t id) { return k.id < id; });
  if (found == keyframes.end() || found->id != keyframe) return std::nullopt;
  return static_cast<int>(found - keyframes.begin());
}

double position_sigma_m(const AnalysedGraph& graph) {
  return std::sqrt(newest_resistance(graph.factor) * graph.position_variance_per_resistance);
}

std::variant<AnalysedGraph, GraphError> analyse_graph(std::span<const Keyframe> keyframes,
                                                      std::span<const KeyframeEdge> edges, const GraphConfig& config,
                                                      double newest_variance_m2) {
  if (keyframes.empty()) return GraphError{"the pose graph has no key-frame"};
  auto component = component_of(keyframes.back().id, edges, config.criterion);
  if (auto* error = std::get_if<GraphError>(&component)) return *error;
  const auto& part = std::get<KeyframeGraph>(component);
  auto selected = select(keyframes, part.keyframes);
  if (!selected) return GraphError{"an edge names a key-frame that the pose graph does not have"};
  if (selected->size() < 2) return GraphError{"the newest key-frame is not connected to any other"};
  auto thinned = sparsify(part.graph, config.sparsifier, config.max_edges);
  if (auto* error = std::get_if<GraphError>(&thinned)) return *error;
  auto factor = LaplacianFactor::make(std::get<WeightedGraph>(thinned));
  if (auto* error = std::get_if<GraphError>(&factor)) return *error;

  AnalysedGraph graph{std::get<WeightedGraph>(std::move(thinned)),
                      config.criterion,
                      std::get<LaplacianFactor>(std::move(factor)),
                      *std::move(selected),
                      {},
                      {},
                      {}};
  graph.loops = loops_of(graph, edges, config.criterion);
  const int newest = static_cast<int>(graph.keyframes.size()) - 1;
  graph.path_from_newest_m = path_lengths_from(newest, part.graph, graph.keyframes);
  graph.travelled_m = travelled(graph.keyframes);
  graph.odometry_weight_metres = calibrate_odometry(graph.factor, graph.keyframes);
  graph.loop_weight = calibrate_loops(graph);
  graph.position_variance_per_resistance =
      std::max(variance_of_edges(edges, config.criterion), newest_variance_m2 / newest_resistance(graph.factor));
  return graph;
}

}  // namespace lapis::planner
