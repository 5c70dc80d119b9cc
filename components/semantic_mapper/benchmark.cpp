// Times are CPU times of the one thread.
// insert: 640x360 RGB-D frames with labels, 5 m range, into the semantic map beside insertion of the same points,
// without classes, into OctoMap in one run. A walk through a flat of six rooms, twice, so that the map first grows and
// is then revisited. loop_correction, local_corrections: what it costs that 1,200 frames follow the pose graph.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <string>
#include <vector>

#include <octomap/OcTree.h>

#include <benchmark/benchmark.h>

#include "common/mapping/integration.hpp"
#include "common/mapping/sensor_model.hpp"
#include "semantic_mapper/core/obstacle_layer.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"
#include "tests/support/synthetic_flat.hpp"

namespace lapis::semantic_mapper {
namespace {

const geometry::PinholeCamera kCamera{640, 360, 320, 320, 319.5, 179.5};
constexpr int kViewsPerRoom = 9;
constexpr int kLaps = 2;
constexpr std::size_t kWorkPerCycle = 1'000'000;  // the component's default

struct View {
  geometry::Pose T_map_camera;
  test::RenderedFrame image;
};

const std::vector<View>& views() {
  static const std::vector<View> kViews = [] {
    const auto flat = test::furnished_flat();
    std::mt19937 random(1);
    std::vector<View> all;
    for (const geometry::Pose& T : test::walk_through_flat(kViewsPerRoom)) {
      all.push_back({T, test::render(flat, kCamera, T)});
      test::add_noise(all.back().image, random);
    }
    return all;
  }();
  return kViews;
}

/// CPU time of this thread [s].
double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Work>
double cpu_s_of(Work&& work) {
  const double begin_s = cpu_s();
  work();
  return cpu_s() - begin_s;
}

double quantile_ms(std::vector<double> seconds, double share) {
  const auto at = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(seconds.size() - 1)));
  std::nth_element(seconds.begin(), seconds.begin() + at, seconds.end());
  return seconds[static_cast<std::size_t>(at)] * 1e3;
}

mapping::CompactFrame compact_frame(const View& view, int stride) {
  std::string error;
  return mapping::CompactFrame::make(kCamera, view.image.depth, &view.image.labels, {stride, 40}, error).value();
}

octomap::Pointcloud point_cloud(const View& view, int stride) {
  octomap::Pointcloud cloud;
  for (int row = 0; row < kCamera.height; row += stride)
    for (int column = 0; column < kCamera.width; column += stride) {
      const float depth_m = view.image.depth(column, row);
      if (depth_m <= 0) continue;
      const Eigen::Vector3f p = (view.T_map_camera * kCamera.unproject(column, row, depth_m)).cast<float>();
      cloud.push_back(p.x(), p.y(), p.z());
    }
  return cloud;
}

std::size_t occupied_voxels(const mapping::VoxelMap& map) {
  const mapping::BeliefReader reader{mapping::SensorModel{}};
  std::size_t count = 0;
  map.for_each_observed([&](const auto&, const mapping::VoxelCounts& counts) { count += reader.is_occupied(counts); });
  return count;
}

std::size_t occupied_voxels(octomap::OcTree& tree) {
  std::size_t count = 0;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const unsigned levels = tree.getTreeDepth() - leaf.getDepth();
    if (tree.isNodeOccupied(*leaf)) count += std::size_t{1} << (3 * levels);
  }
  return count;
}

/// CPU times per frame [s].
std::vector<double> octomap_times(octomap::OcTree& tree, std::size_t frames, int stride) {
  std::vector<double> times;
  for (std::size_t i = 0; i < frames; ++i) {
    const View& view = views()[i % views().size()];
    const octomap::Pointcloud cloud = point_cloud(view, stride);
    const Eigen::Vector3f o = view.T_map_camera.translation().cast<float>();
    times.push_back(cpu_s_of([&] { tree.insertPointCloud(cloud, {o.x(), o.y(), o.z()}, 5.0, false, true); }));
  }
  return times;
}

double ratio(std::size_t a, std::size_t b) { return static_cast<double>(a) / static_cast<double>(b); }

/// One iteration: one frame, from images to updated map. OctoMap gets the same frames afterwards and not in turns,
/// because the allocator would clear up after OctoMap in our time.
void insert_beside_octomap(benchmark::State& state, double resolution_m, int stride) {
  MapperConfig config;
  config.resolution_m = resolution_m;
  SemanticMapper mapper(config);
  std::vector<double> compact_s, total_s;
  std::size_t i = 0, votes = 0;
  for (auto _ : state) {
    const View& view = views()[i % views().size()];
    const double begin_s = cpu_s();
    AnchoredFrame frame{{}, i, view.T_map_camera, geometry::Pose::Identity(), 1, compact_frame(view, stride)};
    compact_s.push_back(cpu_s() - begin_s);
    const IntegrationReport report = mapper.integrate(std::move(frame));
    total_s.push_back(cpu_s() - begin_s);
    state.SetIterationTime(total_s.back());
    votes += report.votes.hit_count() + report.votes.pass_count();
    ++i;
  }
  octomap::OcTree tree(resolution_m);
  const std::vector<double> octomap_s = octomap_times(tree, i, stride);
  state.counters["compact_p50"] = quantile_ms(compact_s, 0.5);
  state.counters["p50"] = quantile_ms(total_s, 0.5);
  state.counters["p95"] = quantile_ms(total_s, 0.95);
  state.counters["octomap_p50"] = quantile_ms(octomap_s, 0.5);
  state.counters["octomap_p95"] = quantile_ms(octomap_s, 0.95);
  state.counters["ratio"] = quantile_ms(octomap_s, 0.5) / quantile_ms(total_s, 0.5);
  state.counters["votes"] = ratio(votes, i);
  state.counters["B_per_voxel"] = ratio(mapper.map().bytes(), occupied_voxels(mapper.map()));
  state.counters["octomap_B_per_voxel"] = ratio(tree.memoryUsage(), occupied_voxels(tree));
  state.counters["B_per_frame"] = ratio(mapper.frame_bytes(), mapper.frames().size());
}

constexpr int kFramesPerKeyframe = 10;
constexpr int kFramesOfLongWalk = 1200;

/// 1,200 frames of the samples that 640x360 pixels have at stride 2.
const std::vector<View>& long_walk() {
  static const std::vector<View> kWalk = [] {
    const auto flat = test::furnished_flat();
    std::mt19937 random(2);
    std::vector<View> all;
    for (const geometry::Pose& T : test::walk_through_flat(kFramesOfLongWalk / 6)) {
      all.push_back({T, test::render(flat, {320, 180, 160, 160, 159.5, 89.5}, T)});
      test::add_noise(all.back().image, random);
    }
    return all;
  }();
  return kWalk;
}

/// A mapper that integrates the long walk, and what that costs.
struct Walker {
  explicit Walker(double resolution_m) : mapper(config_at(resolution_m)) {}

  static MapperConfig config_at(double resolution_m) {
    MapperConfig config;
    config.resolution_m = resolution_m;
    return config;
  }
  static std::size_t keyframe_of(std::size_t frame) { return frame / kFramesPerKeyframe * kFramesPerKeyframe; }

  /// At the key-frame pose that the graph gave last.
  mapping::FrameVotes integrate(std::size_t i) {
    mapping::FrameVotes votes;
    const View& view = long_walk()[i];
    const geometry::Pose& T_map_keyframe = long_walk()[keyframe_of(i)].T_map_camera;
    integration_s.push_back(cpu_s_of([&] {
      std::string error;
      votes = mapper
                  .integrate({{},
                              keyframe_of(i),
                              T_map_keyframe,
                              T_map_keyframe.inverse() * view.T_map_camera,
                              0,
                              mapping::CompactFrame::make({320, 180, 160, 160, 159.5, 89.5}, view.image.depth,
                                                          &view.image.labels, {1, 40}, error)
                                  .value()})
                  .votes;
    }));
    return votes;
  }

  SemanticMapper mapper;
  std::vector<double> integration_s;
};

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// A loop closes at the end of the walk: all frames move, the last ones by half a metre and three degrees.
void loop_correction(benchmark::State& state, double resolution_m) {
  Walker walker(resolution_m);
  const std::size_t frames = long_walk().size();
  for (std::size_t i = 0; i < frames; ++i) walker.integrate(i);
  std::vector<KeyframePose> poses;
  for (std::size_t i = 0; i < frames; i += kFramesPerKeyframe) {
    const double share = ratio(i, frames);
    const geometry::Vector6d xi = (geometry::Vector6d() << 0.4, 0.3, 0.0, 0.0, 0.0, 0.05).finished() * share;
    poses.push_back({i, geometry::se3_exp(xi) * long_walk()[i].T_map_camera});
  }
  std::vector<double> slice_s;
  std::size_t moved = 0;
  double update_s = 0.0;
  for (auto _ : state) {
    update_s = cpu_s_of([&] { walker.mapper.update_keyframe_poses(2, poses); });
    while (walker.mapper.frames_off() > 0)
      slice_s.push_back(cpu_s_of([&] { moved += walker.mapper.re_anchor(kWorkPerCycle); }));
    state.SetIterationTime(update_s + sum(slice_s));
  }
  state.counters["moved"] = static_cast<double>(moved);
  state.counters["slices"] = static_cast<double>(slice_s.size());
  state.counters["slice_p95"] = quantile_ms(slice_s, 0.95);
  state.counters["to_first_integration"] = (update_s + sum(slice_s)) / sum(walker.integration_s) * ratio(frames, moved);
  state.counters["B_per_frame"] = ratio(walker.mapper.frame_bytes(), frames);
}

/// With every new key-frame the newest eight are estimated again, each time with noise: metres and radians per axis.
void local_corrections(benchmark::State& state, double resolution_m, double noise_m, double noise_rad) {
  constexpr std::size_t kWindow = 8;
  Walker walker(resolution_m);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::vector<double> correction_s;
  std::size_t moved = 0;
  for (auto _ : state) {
    for (std::size_t i = 0; i < long_walk().size(); ++i) {
      walker.integrate(i);
      std::vector<KeyframePose> poses;
      for (std::size_t back = 0; back < kWindow && i % kFramesPerKeyframe == 0; ++back) {
        if (i < back * kFramesPerKeyframe) break;
        const std::size_t id = i - back * kFramesPerKeyframe;
        geometry::Vector6d xi;
        for (int k = 0; k < 6; ++k) xi[k] = normal(random) * (k < 3 ? noise_m : noise_rad);
        poses.push_back({id, long_walk()[id].T_map_camera * geometry::se3_exp(xi)});
      }
      correction_s.push_back(cpu_s_of([&] {
        walker.mapper.update_keyframe_poses(i + 1, poses);
        moved += walker.mapper.re_anchor(kWorkPerCycle);
      }));
    }
    state.SetIterationTime(sum(correction_s));
  }
  state.counters["moved"] = static_cast<double>(moved);
  state.counters["p95"] = quantile_ms(correction_s, 0.95);
  state.counters["still_off"] = static_cast<double>(walker.mapper.frames_off());
  state.counters["to_first_integration"] = sum(correction_s) / sum(walker.integration_s);
}

/// One iteration: a frame of a walk at 15 Hz into the obstacle layer, and a grid twice a second, beside its
/// integration.
void obstacles(benchmark::State& state, double resolution_m) {
  Walker walker(resolution_m);
  ObstacleLayer layer({}, {}, resolution_m);
  std::vector<double> add_s, grid_s;
  std::size_t i = 0;
  for (auto _ : state) {
    const mapping::FrameVotes votes = walker.integrate(i);
    const auto stamp = time::Time::from_seconds(static_cast<double>(i) / 15.0);
    add_s.push_back(cpu_s_of([&] { layer.add(stamp, votes); }));
    if (i++ % 8 == 0) grid_s.push_back(cpu_s_of([&] { benchmark::DoNotOptimize(layer.grid()); }));
    state.SetIterationTime(add_s.back());
  }
  state.counters["p50"] = quantile_ms(add_s, 0.5);
  state.counters["p95"] = quantile_ms(add_s, 0.95);
  state.counters["grid_p50"] = quantile_ms(grid_s, 0.5);
  state.counters["to_integration"] = (sum(add_s) + sum(grid_s)) / sum(walker.integration_s);
}

void register_all() {
  const auto once = [](const std::string& name, auto run) {
    benchmark::RegisterBenchmark(name.c_str(), run)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
  };
  for (const auto& [name, resolution_m] : {std::pair{"0.25m", 0.25}, {"0.10m", 0.10}, {"0.05m", 0.05}}) {
    for (const int stride : {1, 2}) {
      const std::string full_name = "insert/" + std::string(name) + "/stride" + std::to_string(stride);
      const auto run = [r = resolution_m, stride](benchmark::State& s) { insert_beside_octomap(s, r, stride); };
      benchmark::RegisterBenchmark(full_name.c_str(), run)
          ->Iterations(static_cast<std::int64_t>(kLaps * views().size()))
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
    const double r = resolution_m;
    once("loop_correction/" + std::string(name), [r](benchmark::State& s) { loop_correction(s, r); });
    once("local_corrections/3mm/" + std::string(name),
         [r](benchmark::State& s) { local_corrections(s, r, 0.003, 0.001); });
    once("local_corrections/10mm/" + std::string(name),
         [r](benchmark::State& s) { local_corrections(s, r, 0.010, 0.0035); });
    benchmark::RegisterBenchmark(("obstacles/" + std::string(name)).c_str(),
                                 [r](benchmark::State& s) { obstacles(s, r); })
        ->Iterations(kFramesOfLongWalk)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace
}  // namespace lapis::semantic_mapper

int main(int argc, char** argv) {
  lapis::semantic_mapper::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
