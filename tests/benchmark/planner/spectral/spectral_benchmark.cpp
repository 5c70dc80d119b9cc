// What the spectral kernel costs on graphs of three laps; `/n` is the number of key-frames.
#include <benchmark/benchmark.h>
#include <Eigen/SparseCholesky>

#include "planner/core/spectral/algebraic_connectivity.hpp"
#include "planner/core/spectral/sparsification.hpp"
#include "tests/unit/planner/spectral/sample_graphs.hpp"

namespace lapis::planner {
namespace {

constexpr unsigned kCandidates = 256;

std::vector<HallucinatedGraph> candidates(int graph_nodes) {
  std::vector<HallucinatedGraph> result;
  for (unsigned seed = 0; seed < kCandidates; ++seed) result.push_back(test::path_with_loops(graph_nodes, seed));
  return result;
}

// Candidates in turn, each from nothing but the factor; also its expected gain: every place alone and all together,
// and the variance of its end with and without loops.
void dopt_candidate(benchmark::State& state, bool with_places) {
  const int n = static_cast<int>(state.range(0));
  const LaplacianFactor factor = test::make_factor(test::three_laps(n));
  const auto paths = candidates(n);
  unsigned next = 0;
  for (auto _ : state) {
    const CandidateGain gain = test::make_gain(factor, paths[next++ % kCandidates]);
    benchmark::DoNotOptimize(gain.d_optimality(kEveryPlace));
    if (!with_places) continue;
    for (int place = 0; place < 4; ++place) benchmark::DoNotOptimize(gain.loop_gain(only_place(place)));
    benchmark::DoNotOptimize(gain.fixed_n_change(kEveryPlace));
    benchmark::DoNotOptimize(gain.variance(n + 7, kNoPlace));
    benchmark::DoNotOptimize(gain.variance(n + 7, kEveryPlace));
  }
}

Eigen::SparseMatrix<double> reduced_laplacian(const WeightedGraph& graph) {
  std::vector<Eigen::Triplet<double>> elements;
  for (const auto& [a, b, weight] : graph.edges()) {
    elements.emplace_back(b - 1, b - 1, weight);
    if (a == 0) continue;
    elements.emplace_back(a - 1, a - 1, weight);
    elements.emplace_back(b - 1, a - 1, -weight);  // the lower triangle
  }
  Eigen::SparseMatrix<double> laplacian(graph.node_count() - 1, graph.node_count() - 1);
  laplacian.setFromTriplets(elements.begin(), elements.end());
  return laplacian;
}

// The same number from scratch, as one would without any of this: Eigen's sparse Cholesky with minimum degree.
void full_factorisation(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  const WeightedGraph graph = test::three_laps(n);
  const auto laplacian = reduced_laplacian(test::extended(graph, test::path_with_loops(n, 0), kEveryPlace));
  for (auto _ : state) {
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(laplacian);
    benchmark::DoNotOptimize(d_optimality(n + 8, factor.vectorD().array().log().sum()));
  }
}

// Once per version of the pose graph.
void factorisation(benchmark::State& state) {
  const WeightedGraph graph = test::three_laps(static_cast<int>(state.range(0)));
  std::size_t size = 0;
  for (auto _ : state) size = test::make_factor(graph).size();
  state.counters["elements"] = static_cast<double>(size);
}

void connectivity(benchmark::State& state) {
  const LaplacianFactor factor = test::make_factor(test::three_laps(static_cast<int>(state.range(0))));
  for (auto _ : state) benchmark::DoNotOptimize(algebraic_connectivity(factor));
}

// A fifth of the edges beside the odometry stays.
SparsificationProblem three_laps_to_thin(int node_count) {
  SparsificationProblem problem{node_count, {}, {}, 0};
  const WeightedGraph graph = test::three_laps(node_count);
  for (const WeightedEdge& edge : graph.edges()) {
    (edge.b == edge.a + 1 ? problem.fixed : problem.candidates).push_back(edge);
  }
  problem.kept = static_cast<int>(problem.candidates.size() / 5);
  return problem;
}

template <class Method>
void sparsification(benchmark::State& state, Method method) {
  const SparsificationProblem problem = three_laps_to_thin(static_cast<int>(state.range(0)));
  Sparsification result;
  for (auto _ : state) result = std::get<Sparsification>(method(problem));
  state.counters["value"] = result.value;
  state.counters["bound"] = result.upper_bound;
}

void by_mac(benchmark::State& state) {
  sparsification(state, [](const SparsificationProblem& problem) { return maximize_connectivity(problem); });
}
void by_greedy_log_det(benchmark::State& state) { sparsification(state, maximize_log_trees); }

constexpr auto kMs = benchmark::kMillisecond;
constexpr auto kUs = benchmark::kMicrosecond;
const std::vector<std::vector<std::int64_t>> kKeyframes = {{100, 300, 1000, 3000, 10000, 30000, 100000}};
BENCHMARK_CAPTURE(dopt_candidate, dopt, false)->Name("dopt_candidate")->ArgsProduct(kKeyframes)->Unit(kUs);
BENCHMARK_CAPTURE(dopt_candidate, all, true)->Name("whole_candidate")->ArgsProduct(kKeyframes)->Unit(kUs);
BENCHMARK(full_factorisation)->ArgsProduct(kKeyframes)->Unit(kMs);
BENCHMARK(factorisation)->ArgsProduct(kKeyframes)->Unit(kMs);
BENCHMARK(connectivity)->Name("algebraic_connectivity")->Arg(1000)->Arg(10000)->Unit(kMs);
BENCHMARK(by_mac)->Name("sparsification_mac")->Arg(1000)->Arg(10000)->Unit(kMs);
BENCHMARK(by_greedy_log_det)->Name("sparsification_log_det")->Arg(1000)->Arg(10000)->Unit(kMs);

}  // namespace
}  // namespace lapis::planner

BENCHMARK_MAIN();
