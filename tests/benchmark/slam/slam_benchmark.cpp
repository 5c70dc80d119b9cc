#include <numbers>
#include <random>

#include <Eigen/Cholesky>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include "slam/core/graph/graph_marginals.hpp"
#include "slam/core/loops/place_index.hpp"
#include "slam/core/mapping/bundle_adjuster.hpp"
#include "slam/core/rgbd_slam.hpp"
#include "tests/unit/slam/synthetic_room.hpp"

namespace lapis::slam {
namespace {

geometry::PinholeCamera camera() { return {640, 360, 320.0, 320.0, 319.5, 179.5}; }

RgbdFrame frame(int index) {
  return test::render_room(camera(), test::room_path(index), time::Time::from_seconds(index / 30.0));
}

void extract_features(benchmark::State& state) {
  const FeatureExtractor extractor{FeatureConfig{}};
  const RgbdFrame input = frame(0);
  for (auto _ : state) benchmark::DoNotOptimize(extractor.extract(input.gray));
}

// Key-frames and their bundle adjustments included.
void track_frame(benchmark::State& state) {
  constexpr int kFrames = 60;
  std::vector<RgbdFrame> frames;
  for (int i = 0; i < kFrames; ++i) frames.push_back(frame(i));
  for (auto _ : state) {
    RgbdSlam slam({}, test::room_path(0));
    for (const RgbdFrame& input : frames) benchmark::DoNotOptimize(slam.process(input));
  }
  state.counters["per_frame"] = benchmark::Counter(kFrames * static_cast<double>(state.iterations()),
                                                   benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

// `state.range(0)` cameras see the same `state.range(1)` points.
void local_bundle(benchmark::State& state) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> side(-1.0, 1.0), away(2.0, 5.0);
  std::normal_distribution<double> normal;
  BundleProblem scene;
  for (int i = 0; i < state.range(0); ++i) {
    scene.cameras.push_back({camera(), geometry::Pose(Eigen::Translation3d(0.05 * i, 0.0, 0.0)), i == 0});
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(state.range(1)); ++k) {
    const Eigen::Vector3d point(side(random), side(random), away(random));
    scene.points_map.emplace_back(point + 0.02 * Eigen::Vector3d(normal(random), normal(random), normal(random)));
    for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
      const Eigen::Vector3d p = scene.cameras[i].T_map_camera.inverse() * point;
      scene.observations.push_back({i, k, camera().project(p), 1.0, p.z()});
    }
  }
  for (auto _ : state) {
    BundleProblem problem = scene;
    benchmark::DoNotOptimize(adjust_bundle({}, {}, problem));
  }
}

// `state.range(0)` key-frames that are views of 50 places, a tenth of each descriptor's bits changed.
void place_query(benchmark::State& state) {
  constexpr int kPlaces = 50;
  std::mt19937_64 random(1);
  const FeatureExtractor extractor{FeatureConfig{}};
  std::vector<std::vector<Feature>> places;
  for (int i = 0; i < kPlaces; ++i) places.push_back(extractor.extract(frame(8 * i).gray));
  const auto seen_again = [&](std::vector<Feature> features) {
    for (Feature& feature : features) {
      feature.depth_m = 1.0;
      for (int k = 0; k < 26; ++k) feature.descriptor[random() % 4] ^= std::uint64_t{1} << (random() % 64);
    }
    return features;
  };
  PlaceIndex index;
  for (KeyframeId id = 0; id < static_cast<KeyframeId>(state.range(0)); ++id) {
    index.add(id, seen_again(places[id % kPlaces]));
  }
  const auto query = seen_again(places[7]);
  for (auto _ : state) benchmark::DoNotOptimize(index.query(query, 3, [](KeyframeId) { return true; }));
}

// Laps of 200 key-frames, each with an edge of vision and one of odometry to the one before, and every tenth with a
// loop to the lap before.
PoseGraphSnapshot laps(std::uint64_t keyframes) {
  constexpr std::uint64_t kLap = 200;
  PoseGraphSnapshot graph;
  const geometry::Matrix6d information = 1e4 * geometry::Matrix6d::Identity();
  const auto add_edge = [&](std::uint64_t from, std::uint64_t to, EdgeType type) {
    const geometry::Pose T_from_to = graph.nodes[from].T_map_camera.inverse() * graph.nodes[to].T_map_camera;
    graph.edges.push_back({from, to, type, T_from_to, information});
  };
  for (std::uint64_t id = 0; id < keyframes; ++id) {
    geometry::Pose T = geometry::Pose::Identity();
    T.rotate(Eigen::AngleAxisd(2.0 * std::numbers::pi * static_cast<double>(id) / kLap, Eigen::Vector3d::UnitY()));
    T.translation() = 8.0 * T.linear().col(2);
    graph.nodes.push_back({id, {}, T});
    if (id > 0) add_edge(id - 1, id, EdgeType::kOdometry);
    if (id > 0) add_edge(id - 1, id, EdgeType::kWheelOdometry);
    if (id >= kLap && id % 10 == 0) add_edge(id - kLap, id, EdgeType::kLoopClosure);
  }
  return graph;
}

void marginals(benchmark::State& state) {
  const PoseGraphSnapshot graph = laps(static_cast<std::uint64_t>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(graph_marginals(graph));
}

// What marginals() would cost without the graph's sparsity: a matrix of the same size.
void dense_inverse(benchmark::State& state) {
  const auto size = static_cast<Eigen::Index>(6 * state.range(0));
  const Eigen::MatrixXd matrix = Eigen::MatrixXd::Random(size, size).selfadjointView<Eigen::Lower>().toDenseMatrix() +
                                 static_cast<double>(size) * Eigen::MatrixXd::Identity(size, size);
  for (auto _ : state) {
    const Eigen::MatrixXd inverse = matrix.llt().solve(Eigen::MatrixXd::Identity(size, size));
    benchmark::DoNotOptimize(inverse.data());
  }
}

BENCHMARK(extract_features)->Name("extract_features/640x360")->Unit(benchmark::kMillisecond);
BENCHMARK(track_frame)->Name("track_60_frames/640x360")->Unit(benchmark::kMillisecond);
BENCHMARK(place_query)->Name("place_query")->Arg(1000)->Arg(5000)->Unit(benchmark::kMillisecond);
BENCHMARK(local_bundle)->Name("local_bundle")->Args({6, 300})->Args({10, 1000})->Unit(benchmark::kMillisecond);
BENCHMARK(marginals)->Arg(300)->Arg(1000)->Arg(10000)->Unit(benchmark::kMillisecond);
BENCHMARK(dense_inverse)->Arg(300)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapis::slam

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
