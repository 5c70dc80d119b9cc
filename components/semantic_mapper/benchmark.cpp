// Insertion of 640x360 RGB-D frames, 5 m range, into the semantic map and, as the peer in the same run, of the same
// pixels into OctoMap without classes. A frame of a furnished room, seen from places on a circle.

#include <cmath>
#include <string>
#include <vector>

#include <octomap/OcTree.h>

#include <benchmark/benchmark.h>

#include "common/mapping/integration.hpp"
#include "common/mapping/tile_codec.hpp"
#include "semantic_mapper/core/export.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"
#include "tests/support/synthetic_room.hpp"

namespace lapis::semantic_mapper {
namespace {

const geometry::PinholeCamera kCamera{640, 360, 320, 320, 319.5, 179.5};
constexpr int kFrames = 24;

struct View {
  geometry::Pose T_map_camera;
  test::RenderedFrame image;
};

const std::vector<View>& views() {
  static const std::vector<View> kViews = [] {
    const auto room = test::furnished_room();
    std::vector<View> all;
    for (int i = 0; i < kFrames; ++i) {
      const double angle = 2.0 * M_PI * i / kFrames;
      const auto T = test::look({1.5 * std::cos(angle), 1.2 * std::sin(angle), 1.1}, angle + 2.5, 0.15);
      all.push_back({T, test::render(room, kCamera, T)});
    }
    return all;
  }();
  return kViews;
}

std::vector<mapping::CompactFrame> compact_frames(int stride) {
  std::vector<mapping::CompactFrame> frames;
  std::string error;
  for (const View& view : views())
    frames.push_back(
        mapping::CompactFrame::make(kCamera, view.image.depth, &view.image.labels, {stride, 40}, error).value());
  return frames;
}

/// From the stored compact frame to the updated map, unpacking included.
void semantic_insert(benchmark::State& state, double resolution_m, int stride) {
  const std::vector<mapping::CompactFrame> frames = compact_frames(stride);
  mapping::VoxelMap map(resolution_m);
  std::size_t i = 0, hits = 0, passes = 0;
  for (auto _ : state) {
    const std::size_t k = i++ % frames.size();
    const auto votes = mapping::compute_votes(frames[k], views()[k].T_map_camera, {}, resolution_m);
    map.add(votes);
    benchmark::DoNotOptimize(map);
    hits += votes.hit_count();
    passes += votes.pass_count();
  }
  state.counters["hits"] = static_cast<double>(hits) / static_cast<double>(i);
  state.counters["passes"] = static_cast<double>(passes) / static_cast<double>(i);
  state.counters["map_MB"] = static_cast<double>(map.bytes()) * 1e-6;
}

/// From the images to the stored compact frame.
void compact_frame(benchmark::State& state, int stride) {
  std::size_t i = 0, bytes = 0;
  std::string error;
  for (auto _ : state) {
    const View& view = views()[i++ % views().size()];
    const auto frame = mapping::CompactFrame::make(kCamera, view.image.depth, &view.image.labels, {stride, 40}, error);
    bytes += frame->bytes();
  }
  state.counters["bytes"] = static_cast<double>(bytes) / static_cast<double>(i);
}

void octomap_insert(benchmark::State& state, double resolution_m) {
  std::vector<octomap::Pointcloud> clouds(views().size());
  for (std::size_t k = 0; k < views().size(); ++k)
    for (int row = 0; row < kCamera.height; ++row)
      for (int column = 0; column < kCamera.width; ++column) {
        const float depth_m = views()[k].image.depth(column, row);
        if (depth_m <= 0) continue;
        const Eigen::Vector3f p = (views()[k].T_map_camera * kCamera.unproject(column, row, depth_m)).cast<float>();
        clouds[k].push_back(p.x(), p.y(), p.z());
      }
  octomap::OcTree tree(resolution_m);
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t k = i++ % clouds.size();
    const Eigen::Vector3f origin = views()[k].T_map_camera.translation().cast<float>();
    tree.insertPointCloud(clouds[k], {origin.x(), origin.y(), origin.z()}, 5.0, /*lazy_eval=*/false,
                          /*discretize=*/true);
  }
  state.counters["map_MB"] = static_cast<double>(tree.memoryUsage()) * 1e-6;
}

/// Every tile of the room's map.
void encode_tiles(benchmark::State& state, double resolution_m) {
  MapperConfig config;
  config.resolution_m = resolution_m;
  SemanticMapper mapper(config);
  std::vector<mapping::CompactFrame> frames = compact_frames(2);
  for (std::size_t k = 0; k < frames.size(); ++k)
    mapper.integrate({{}, k, views()[k].T_map_camera, geometry::Pose::Identity(), 1, std::move(frames[k])});
  mapper.take_changed_tiles();
  std::size_t bytes = 0, tiles = 0;
  for (auto _ : state) {
    const auto all = mapper.all_tiles();
    bytes = 0;
    tiles = all.size();
    for (const TileUpdate& tile : all) bytes += tile.bytes.size();
  }
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["tiles"] = static_cast<double>(tiles);
}

void register_all() {
  for (const auto& [name, resolution_m] : {std::pair{"0.25m", 0.25}, {"0.10m", 0.10}, {"0.05m", 0.05}}) {
    const auto named = [name = std::string(name)](const char* kernel) { return kernel + ("/" + name); };
    const double r = resolution_m;
    const auto add = [](const std::string& full_name, auto run) {
      benchmark::RegisterBenchmark(full_name.c_str(), run)->Unit(benchmark::kMillisecond);
    };
    add(named("semantic_insert"), [r](benchmark::State& s) { semantic_insert(s, r, 2); });
    add(named("semantic_insert_all_pixels"), [r](benchmark::State& s) { semantic_insert(s, r, 1); });
    add(named("octomap_insert"), [r](benchmark::State& s) { octomap_insert(s, r); });
    add(named("encode_tiles"), [r](benchmark::State& s) { encode_tiles(s, r); });
  }
  for (const int stride : {1, 2})
    benchmark::RegisterBenchmark(("compact_frame/stride" + std::to_string(stride)).c_str(), [stride](
                                                                                                benchmark::State& s) {
      compact_frame(s, stride);
    })->Unit(benchmark::kMillisecond);
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
