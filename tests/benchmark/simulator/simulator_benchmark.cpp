// What the simulator costs, on the bundled flat: frames, loading, noise. CPU time of the process; one render thread.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <filesystem>
#include <numbers>

#include "simulator/core/simulation.hpp"
#include "simulator/core/views.hpp"
#include "simulator/set_up.hpp"

namespace {

using namespace lapis;
using namespace lapis::simulator;

constexpr int kViews = 12;

SimulatorConfig apartment() {
  SimulatorConfig config;
  config.scene = "apartment";
  config.seed = 1;
  return config;
}

const World& world() {
  static const World shared = open_world(apartment());
  return shared;
}

/// Places along the bundled tour, each with another heading.
std::vector<geometry::Pose> poses() {
  const auto& tour = world().scene().tour;
  const auto mount = camera_mount(apartment().robot.camera);
  std::vector<geometry::Pose> out;
  for (int i = 0; i < kViews; ++i) {
    const auto& p = tour[static_cast<std::size_t>(i) * tour.size() / kViews];
    out.push_back(T_world_camera(world(), mount, p, 2.0 * std::numbers::pi * i / kViews));
  }
  return out;
}

void add_size(benchmark::State& state) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["triangles"] = static_cast<double>(world().scene().mesh.triangles.size());
  state.counters["peak_rss_mb"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void render(benchmark::State& state, bool with_color) {
  const auto views = poses();
  const auto camera = pinhole_camera(apartment().robot.camera);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(world().renderer().render(camera, views[i++ % views.size()], with_color));
  }
  add_size(state);
}

void simulate_frame(benchmark::State& state) {
  SimulatorConfig config = apartment();
  Simulation simulation(world(), simulation_config(config), start_pose(world(), config));
  for (auto _ : state) benchmark::DoNotOptimize(simulation.next(DriveCommand{0.0, 0.5}));
}

void load(benchmark::State& state, bool with_cache) {
  SimulatorConfig config = apartment();
  const auto folder = std::filesystem::temp_directory_path() / "lapis_simulator_benchmark_light";
  config.world.light_folder = folder.string();
  if (with_cache) open_world(config);
  for (auto _ : state) {
    if (!with_cache) std::filesystem::remove_all(folder);
    benchmark::DoNotOptimize(open_world(config));
  }
  std::filesystem::remove_all(folder);
}

void register_all() {
  const auto add = [](const char* name, auto&& function) {
    return benchmark::RegisterBenchmark(name, function)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
  };
  add("render/rgb_depth_label/640x360", [](auto& state) { render(state, true); })->MinTime(2.0);
  add("render/depth_label/640x360", [](auto& state) { render(state, false); })->MinTime(2.0);
  add("frame_with_noise/640x360", [](auto& state) { simulate_frame(state); })->MinTime(2.0);
  add("load/first_time", [](auto& state) { load(state, false); })->Iterations(1);
  add("load/from_cache", [](auto& state) { load(state, true); })->Iterations(3);
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  register_all();
  benchmark::RunSpecifiedBenchmarks();
}
