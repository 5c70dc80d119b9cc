// loop_correction, local_corrections: what it costs that 1,200 frames follow the pose graph. obstacles: what the
// obstacle layer costs. Frames with noise of a tour of large_building, 640x360, stride 2.

#include <cstddef>
#include <iterator>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "semantic_mapper/core/obstacle_layer.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"
#include "simulator/set_up.hpp"
#include "tests/benchmark/semantic_mapper/benchmarks.hpp"

namespace lapis::semantic_mapper::benchmarks {
namespace {

constexpr std::size_t kFramesPerKeyframe = 10;
constexpr std::size_t kFrames = 1200;             // that are corrected
constexpr std::size_t kFramesMeanwhile = 60;      // that come while they are
constexpr std::size_t kWorkPerCycle = 1'000'000;  // the component's default
constexpr double kRate_hz = 15.0;

struct View {
  geometry::Pose T_map_camera;
  mapping::CompactFrame frame;
};

mapping::CompactFrame compact_frame(const geometry::PinholeCamera& camera, const simulator::CameraImages& images) {
  geometry::DepthImage depth(camera.width, camera.height);
  std::transform(images.depth_mm.pixels.begin(), images.depth_mm.pixels.end(), depth.pixels.begin(),
                 [](std::uint16_t mm) { return 1e-3f * static_cast<float>(mm); });
  std::string error;
  return mapping::CompactFrame::make(camera, depth, &images.labels, {}, error).value();
}

/// The first frames of the tour, with their true poses.
std::vector<View> tour_of_large_building() {
  simulator::SimulatorConfig config;
  config.scene = "large_building";
  config.tour = "bundled";
  const simulator::World world = simulator::open_world(config);
  const simulator::StartPose start = simulator::start_pose(world, config);
  auto tour = simulator::plan_tour(world, start, config);
  simulator::Simulation simulation(world, simulator::simulation_config(config), start);
  const auto camera = robot::pinhole_camera(config.robot.camera);
  const geometry::Pose T_base_camera = geometry::T_base_camera(robot::camera_mount(config.robot.camera));
  std::vector<View> views;
  std::optional<simulator::DriveCommand> command;
  while (views.size() < kFrames + kFramesMeanwhile) {
    const simulator::SensorFrame frame = simulation.next(command);
    views.push_back({frame.T_world_base * T_base_camera, compact_frame(camera, frame.images)});
    command = tour->command(frame.robot);
  }
  return views;
}

const std::vector<View>& walk() {
  static const std::vector<View> kWalk = tour_of_large_building();
  return kWalk;
}

/// A mapper that integrates the walk, and what that costs.
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
    const geometry::Pose& T_map_keyframe = walk()[keyframe_of(i)].T_map_camera;
    integration_s.push_back(cpu_s_of([&] {
      votes = mapper
                  .integrate({{},
                              keyframe_of(i),
                              T_map_keyframe,
                              T_map_keyframe.inverse() * walk()[i].T_map_camera,
                              0,
                              walk()[i].frame})
                  .votes;
    }));
    return votes;
  }

  SemanticMapper mapper;
  std::vector<double> integration_s;
};

double sum(const std::vector<double>& values) { return std::accumulate(values.begin(), values.end(), 0.0); }

/// Key-frames after a loop has closed at the end of the walk: the last ones are off by half a metre and three degrees.
std::vector<KeyframePose> corrected_keyframes() {
  std::vector<KeyframePose> poses;
  for (std::size_t i = 0; i < kFrames; i += kFramesPerKeyframe) {
    const geometry::Vector6d xi =
        (geometry::Vector6d() << 0.4, 0.3, 0.0, 0.0, 0.0, 0.05).finished() * ratio(i, kFrames);
    poses.push_back({i, geometry::se3_exp(xi) * walk()[i].T_map_camera});
  }
  return poses;
}

/// A loop closes, and all frames move; a new frame comes before each slice, until none are left. The times of the
/// correction are without those of the new frames; a cycle has both.
void loop_correction(benchmark::State& state, double resolution_m) {
  Walker walker(resolution_m);
  for (std::size_t i = 0; i < kFrames; ++i) walker.integrate(i);
  const double first_s = sum(walker.integration_s);
  const std::vector<KeyframePose> poses = corrected_keyframes();
  std::vector<double> slice_s, cycle_s;
  std::size_t moved = 0;
  double update_s = 0.0;
  for (auto _ : state) {
    update_s = cpu_s_of([&] { walker.mapper.update_keyframe_poses(2, poses); });
    while (walker.mapper.frames_off() > 0) {
      const std::size_t next = kFrames + cycle_s.size() % kFramesMeanwhile;
      cycle_s.push_back(cpu_s_of([&] {
        walker.integrate(next);
        slice_s.push_back(cpu_s_of([&] { moved += walker.mapper.re_anchor(kWorkPerCycle); }));
      }));
    }
    state.SetIterationTime(update_s + sum(slice_s));
  }
  state.counters["moved"] = static_cast<double>(moved);
  state.counters["cycles"] = static_cast<double>(cycle_s.size());
  state.counters["cycle_p95"] = quantile_ms(cycle_s, 0.95);
  state.counters["cycle_max"] = quantile_ms(cycle_s, 1.0);
  state.counters["to_first_integration"] = (update_s + sum(slice_s)) / first_s * ratio(kFrames, moved);
  state.counters["B_per_frame"] = ratio(walker.mapper.frame_bytes(), walker.mapper.frames().size());
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
    for (std::size_t i = 0; i < kFrames; ++i) {
      walker.integrate(i);
      std::vector<KeyframePose> poses;
      for (std::size_t back = 0; back < kWindow && i % kFramesPerKeyframe == 0; ++back) {
        if (i < back * kFramesPerKeyframe) break;
        const std::size_t id = i - back * kFramesPerKeyframe;
        geometry::Vector6d xi;
        for (int k = 0; k < 6; ++k) xi[k] = normal(random) * (k < 3 ? noise_m : noise_rad);
        poses.push_back({id, walk()[id].T_map_camera * geometry::se3_exp(xi)});
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

/// One iteration: a frame of the tour, at 15 Hz, into the obstacle layer, and a grid twice a second, beside its
/// integration.
void obstacles(benchmark::State& state, double resolution_m) {
  Walker walker(resolution_m);
  ObstacleLayer layer({}, {}, resolution_m);
  std::vector<double> add_s, grid_s;
  std::size_t i = 0;
  for (auto _ : state) {
    const mapping::FrameVotes votes = walker.integrate(i);
    const auto stamp = time::Time::from_seconds(static_cast<double>(i) / kRate_hz);
    add_s.push_back(cpu_s_of([&] { layer.add(stamp, votes); }));
    if (i++ % 8 == 0) grid_s.push_back(cpu_s_of([&] { benchmark::DoNotOptimize(layer.grid()); }));
    state.SetIterationTime(add_s.back());
  }
  state.counters["p50"] = quantile_ms(add_s, 0.5);
  state.counters["p95"] = quantile_ms(add_s, 0.95);
  state.counters["grid_p50"] = quantile_ms(grid_s, 0.5);
  state.counters["to_integration"] = (sum(add_s) + sum(grid_s)) / sum(walker.integration_s);
}

}  // namespace

void register_corrections() {
  const auto once = [](const std::string& name, auto run) {
    benchmark::RegisterBenchmark(name.c_str(), run)->Iterations(1)->UseManualTime()->Unit(benchmark::kMillisecond);
  };
  for (const auto& [name, resolution_m] : {std::pair{"0.25m", 0.25}, {"0.10m", 0.10}, {"0.05m", 0.05}}) {
    const double r = resolution_m;
    once("loop_correction/" + std::string(name), [r](benchmark::State& s) { loop_correction(s, r); });
    once("local_corrections/3mm/" + std::string(name),
         [r](benchmark::State& s) { local_corrections(s, r, 0.003, 0.001); });
    once("local_corrections/10mm/" + std::string(name),
         [r](benchmark::State& s) { local_corrections(s, r, 0.010, 0.0035); });
    benchmark::RegisterBenchmark(("obstacles/" + std::string(name)).c_str(),
                                 [r](benchmark::State& s) { obstacles(s, r); })
        ->Iterations(kFrames)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  }
}

}  // namespace lapis::semantic_mapper::benchmarks
