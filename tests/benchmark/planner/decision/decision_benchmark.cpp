// decide/N: what a decision with 20 candidates costs, N key-frames in the pose graph. The map: apartment after half of
// its bundled tour, at true poses, 0.25 m; views of 2,304 rays, as many of them along a path that a candidate has ten
// in the mean; key-frames evenly on what was driven, each joined to the two before it and to those of old that stand
// near; landmarks on the surfaces that the key-frames saw. CPU time of all threads.

#include <algorithm>
#include <cmath>
#include <map>
#include <variant>
#include <vector>

#include <benchmark/benchmark.h>

#include "planner/core/decision/decision.hpp"
#include "planner/core/exploration/surroundings.hpp"
#include "planner/core/methods/methods.hpp"
#include "tests/benchmark/planner/half_explored.hpp"

namespace lapis::planner {
namespace {

constexpr std::size_t kCandidates = 20;
constexpr double kViewsPerPath = 10.0;
constexpr std::size_t kNear = 30;  // key-frames between which an edge is no loop
constexpr double kResolution_m = 0.25;

struct GraphParts {
  std::vector<Keyframe> keyframes;
  std::vector<KeyframeEdge> edges;
  std::map<mapping::TileIndex, mapping::LandmarkTile> landmarks;
};

geometry::Matrix6d information(double path_m) {
  const double sigma = 0.005 + 0.01 * path_m;
  return geometry::Matrix6d::Identity() / (sigma * sigma);
}

void join(GraphParts& parts, std::size_t from, std::size_t to, bool is_loop) {
  const double path_m = path_between(parts.keyframes[from].T_map_camera, parts.keyframes[to].T_map_camera);
  parts.edges.push_back({parts.keyframes[from].id, parts.keyframes[to].id, information(path_m), is_loop});
}

Eigen::Vector3d point_of(const mapping::CompactFrame& frame, std::size_t sample) {
  const auto columns = static_cast<std::size_t>(frame.columns()), stride = static_cast<std::size_t>(frame.stride());
  const std::size_t column = sample % columns * stride, row = sample / columns * stride;
  const double z = 1e-3 * frame.depth_mm()[sample];
  return {z * (static_cast<double>(column) - frame.camera().cx) / frame.camera().fx,
          z * (static_cast<double>(row) - frame.camera().cy) / frame.camera().fy, z};
}

/// A hundred points that the key-frame saw, and those before and after it.
void add_landmarks(const mapping::CompactFrame& frame, const geometry::Pose& T_map_camera, std::uint32_t keyframe,
                   std::uint32_t count, mapping::LandmarkTile& tile) {
  const std::size_t step = frame.samples() / 100;
  for (std::size_t i = keyframe % step; i < frame.samples(); i += step) {
    if (frame.depth_mm()[i] == 0) continue;
    tile.ids.push_back(static_cast<std::uint32_t>(tile.ids.size()));
    tile.positions_m.emplace_back((T_map_camera * point_of(frame, i)).cast<float>());
    for (std::uint32_t k = std::max(keyframe, 1u) - 1; k <= std::min(keyframe + 1, count - 1); ++k)
      tile.observers.push_back(k);
    tile.observer_ends.push_back(static_cast<std::uint32_t>(tile.observers.size()));
  }
}

GraphParts graph_of(std::size_t count) {
  GraphParts parts;
  mapping::LandmarkTile& tile = parts.landmarks[{}];
  const std::size_t driven = test::tour().frames.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t frame = i * driven / count;
    const geometry::Pose& pose = test::tour().T_map_camera[frame];
    parts.keyframes.push_back({i, pose});
    add_landmarks(test::tour().frames[frame], pose, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(count),
                  tile);
    for (std::size_t back = 1; back <= std::min<std::size_t>(i, 2); ++back) join(parts, i - back, i, false);
    for (std::size_t old = 0; old + kNear < i; old += kNear) {
      if (path_between(parts.keyframes[old].T_map_camera, pose) < 1.0) join(parts, old, i, true);
    }
  }
  return parts;
}

/// Half of the apartment, and who is in it.
struct World {
  World() : surroundings({}, mapping::SensorModel{}, kResolution_m), view(view_config()) {
    const mapping::VoxelMap map = test::half_explored_map(kResolution_m);
    surroundings.update_map(map, map.sorted_blocks());
    const geometry::Pose& T_map_camera = test::tour().T_map_camera[test::tour().frames.size() - 1];
    const geometry::Pose T_map_base = T_map_camera * T_base_camera().inverse();
    robot.p_map = T_map_base.translation().head<2>();
    robot.yaw_rad = std::atan2(T_map_base.linear()(1, 0), T_map_base.linear()(0, 0));
  }
  static geometry::Pose T_base_camera() {
    return geometry::T_base_camera(robot::camera_mount(test::apartment().robot.camera));
  }
  static ViewConfig view_config() {
    ViewConfig config;
    config.camera = robot::pinhole_camera(test::apartment().robot.camera);
    return config;
  }

  Surroundings surroundings;
  View view;
  Pose2 robot;
};

const World& world() {
  static const World kWorld;
  return kWorld;
}

double views_per_candidate(const Decision& decision) {
  std::size_t open = 0, views = 0;
  for (const Candidate& candidate : decision.candidates) {
    if (!candidate.is_open()) continue;
    ++open;
    views += candidate.path.size();
  }
  return static_cast<double>(views) / static_cast<double>(std::max<std::size_t>(open, 1));
}

Situation situation(const AnalysedGraph& graph, const LandmarkIndex& landmarks) {
  const Surroundings& s = world().surroundings;
  return {s.grid(), s.frontiers(), s.field(), world().view, World::T_base_camera(), &graph, &landmarks, world().robot};
}

/// The view spacing with which paths have as many views as wanted.
DecisionConfig config_for(const Situation& now) {
  DecisionConfig config;
  config.method = make_method("joint");
  config.max_candidates = kCandidates;
  while (config.view_spacing_m > 0.1 && views_per_candidate(decide(now, {}, config)) < kViewsPerPath)
    config.view_spacing_m -= 0.05;
  return config;
}

void decision(benchmark::State& state) {
  const GraphParts parts = graph_of(static_cast<std::size_t>(state.range(0)));
  const auto graph = std::get<AnalysedGraph>(analyse_graph(parts.keyframes, parts.edges));
  const LandmarkIndex landmarks(parts.landmarks, graph, kResolution_m);
  const Situation now = situation(graph, landmarks);
  const DecisionConfig config = config_for(now);
  Decision made;
  for (auto _ : state) made = decide(now, {}, config);
  const auto open = static_cast<std::size_t>(
      std::count_if(made.candidates.begin(), made.candidates.end(), [](const auto& c) { return c.is_open(); }));
  if (open < kCandidates || views_per_candidate(made) < kViewsPerPath) state.SkipWithError("fewer candidates or views");
  state.counters["candidates"] = static_cast<double>(open);
  state.counters["views_per_candidate"] = views_per_candidate(made);
  state.counters["rays_per_view"] = static_cast<double>(world().view.directions().size());
  state.counters["landmarks"] = static_cast<double>(landmarks.size());
}

/// Once per version of the pose graph.
void knowledge(benchmark::State& state) {
  const GraphParts parts = graph_of(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) {
    const auto graph = std::get<AnalysedGraph>(analyse_graph(parts.keyframes, parts.edges));
    benchmark::DoNotOptimize(LandmarkIndex(parts.landmarks, graph, kResolution_m).size());
  }
  state.counters["edges"] = static_cast<double>(parts.edges.size());
}

const std::vector<std::vector<std::int64_t>> kKeyframes = {{100, 300, 1000, 3000, 10000}};
BENCHMARK(decision)->Name("decide")->ArgsProduct(kKeyframes)->MeasureProcessCPUTime()->Unit(benchmark::kMillisecond);
BENCHMARK(knowledge)
    ->Name("graph_and_landmarks")
    ->ArgsProduct(kKeyframes)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapis::planner

BENCHMARK_MAIN();
