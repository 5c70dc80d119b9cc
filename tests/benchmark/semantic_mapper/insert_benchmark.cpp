// insert: 640x360 RGB-D frames with labels, 5 m range, into the semantic map beside insertion of the same points,
// without classes, into OctoMap in one run. A walk through a flat of six rooms, twice, so that the map first grows and
// is then revisited.

#include <random>
#include <string>
#include <vector>

#include <octomap/OcTree.h>

#include <benchmark/benchmark.h>

#include "common/mapping/model/sensor_model.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"
#include "tests/benchmark/semantic_mapper/benchmarks.hpp"
#include "tests/support/synthetic_flat.hpp"

namespace lapis::semantic_mapper::benchmarks {
namespace {

const geometry::PinholeCamera kCamera{640, 360, 320, 320, 319.5, 179.5};
constexpr int kViewsPerRoom = 9;
constexpr int kLaps = 2;

struct InsertedView {
  geometry::Pose T_map_camera;
  test::RenderedFrame image;
};

const std::vector<InsertedView>& views() {
  static const std::vector<InsertedView> kViews = [] {
    const auto flat = test::furnished_flat();
    std::mt19937 random(1);
    std::vector<InsertedView> all;
    for (const geometry::Pose& T : test::walk_through_flat(kViewsPerRoom)) {
      all.push_back({T, test::render(flat, kCamera, T)});
      test::add_noise(all.back().image, random);
    }
    return all;
  }();
  return kViews;
}

mapping::CompactFrame compact_frame(const InsertedView& view, int stride) {
  std::string error;
  return mapping::CompactFrame::make(kCamera, view.image.depth, &view.image.labels, {stride, 40}, error).value();
}

octomap::Pointcloud point_cloud(const InsertedView& view, int stride) {
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
    const InsertedView& view = views()[i % views().size()];
    const octomap::Pointcloud cloud = point_cloud(view, stride);
    const Eigen::Vector3f o = view.T_map_camera.translation().cast<float>();
    times.push_back(cpu_s_of([&] { tree.insertPointCloud(cloud, {o.x(), o.y(), o.z()}, 5.0, false, true); }));
  }
  return times;
}

/// One iteration: one frame, from images to updated map. OctoMap gets the same frames afterwards and not in turns,
/// because the allocator would clear up after OctoMap in our time.
void insert_beside_octomap(benchmark::State& state, double resolution_m, int stride) {
  MapperConfig config;
  config.resolution_m = resolution_m;
  SemanticMapper mapper(config);
  std::vector<double> compact_s, total_s;
  std::size_t i = 0, votes = 0;
  for (auto _ : state) {
    const InsertedView& view = views()[i % views().size()];
    const double begin_s = cpu_s();
    AnchoredFrame frame{{}, i, view.T_map_camera, geometry::Pose::Identity(), 1, compact_frame(view, stride)};
    compact_s.push_back(cpu_s() - begin_s);
    const IntegrationReport report = mapper.integrate(std::move(frame));
    total_s.push_back(cpu_s() - begin_s);
    state.SetIterationTime(total_s.back());
    votes += report.votes.hit_count() + report.votes.miss_count();
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

}  // namespace

void register_insert() {
  for (const auto& [name, resolution_m] : {std::pair{"0.25m", 0.25}, {"0.10m", 0.10}, {"0.05m", 0.05}}) {
    for (const int stride : {1, 2}) {
      const std::string full_name = "insert/" + std::string(name) + "/stride" + std::to_string(stride);
      const auto run = [r = resolution_m, stride](benchmark::State& s) { insert_beside_octomap(s, r, stride); };
      benchmark::RegisterBenchmark(full_name.c_str(), run)
          ->Iterations(static_cast<std::int64_t>(kLaps * views().size()))
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace lapis::semantic_mapper::benchmarks
