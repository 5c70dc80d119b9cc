#include "tests/unit/planner/spectral/sample_graphs.hpp"

#include <random>
#include <stdexcept>

namespace lapis::planner::test {
namespace {

template <class Value>
Value value_of(std::variant<Value, GraphError> result) {
  if (const auto* error = std::get_if<GraphError>(&result)) throw std::runtime_error(error->message);
  return std::get<Value>(std::move(result));
}

// Not a std distribution: these differ between standard libraries.
class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(engine_()) / 4294967296.0; }
  int below(int end) { return static_cast<int>(between(0.0, end)); }

 private:
  std::mt19937 engine_;
};

}  // namespace

WeightedGraph make_graph(int node_count, std::vector<WeightedEdge> edges) {
  return value_of(WeightedGraph::make(node_count, std::move(edges)));
}
LaplacianFactor make_factor(const WeightedGraph& graph) { return value_of(LaplacianFactor::make(graph)); }
CandidateGain make_gain(const LaplacianFactor& factor, const HallucinatedGraph& candidate) {
  return value_of(CandidateGain::make(factor, candidate));
}

WeightedGraph three_laps(int node_count) {
  Draw draw(1);
  std::vector<WeightedEdge> edges;
  const int lap = node_count / 3;
  for (int node = 0; node < node_count; ++node) {
    for (const int other : {node + 1, node + 2, node + lap, node + lap + 1}) {
      if (other < node_count) edges.push_back({node, other, draw.between(50.0, 150.0)});
    }
  }
  return make_graph(node_count, std::move(edges));
}

WeightedGraph random_graph(int node_count, int extra, unsigned seed) {
  Draw draw(seed);
  std::vector<WeightedEdge> edges;
  for (int node = 1; node < node_count; ++node) edges.push_back({node - 1, node, draw.between(0.5, 20.0)});
  for (int i = 0; i < extra; ++i) {
    const int a = draw.below(node_count);
    edges.push_back({a, (a + 1 + draw.below(node_count - 1)) % node_count, draw.between(0.5, 20.0)});
  }
  return make_graph(node_count, std::move(edges));
}

HallucinatedGraph path_with_loops(int graph_nodes, unsigned seed) {
  constexpr int kNewNodes = 8, kLoops = 4;
  Draw draw(seed);
  HallucinatedGraph candidate{kNewNodes, {}};
  for (int node = graph_nodes; node < graph_nodes + kNewNodes; ++node) {
    candidate.edges.push_back({{node - 1, node, draw.between(50.0, 150.0)}});
  }
  for (int loop = 0; loop < kLoops; ++loop) {
    const int old = static_cast<int>((loop + draw.between(0.0, 1.0)) * (graph_nodes - 1) / kLoops);
    candidate.edges.push_back({{graph_nodes + draw.below(kNewNodes), old, draw.between(20.0, 60.0)}, loop});
  }
  return candidate;
}

WeightedGraph extended(const WeightedGraph& graph, const HallucinatedGraph& candidate, PlaceSet places) {
  std::vector<WeightedEdge> edges = graph.edges();
  for (const HallucinatedEdge& edge : candidate.edges) {
    const bool is_certain = edge.place == HallucinatedEdge::kCertain;
    if (is_certain || (places & only_place(edge.place)) != 0) edges.push_back(edge.edge);
  }
  return make_graph(graph.node_count() + candidate.node_count, std::move(edges));
}

Eigen::MatrixXd dense_laplacian(const WeightedGraph& graph) {
  Eigen::MatrixXd laplacian = Eigen::MatrixXd::Zero(graph.node_count(), graph.node_count());
  for (const WeightedEdge& edge : graph.edges()) {
    laplacian(edge.a, edge.a) += edge.weight;
    laplacian(edge.b, edge.b) += edge.weight;
    laplacian(edge.a, edge.b) -= edge.weight;
    laplacian(edge.b, edge.a) -= edge.weight;
  }
  return laplacian;
}

}  // namespace lapis::planner::test
