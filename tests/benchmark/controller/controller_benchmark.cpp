// CPU time of the controller's parts in a furnished flat of six rooms: 640x360 images, places in the middle of rooms.
#include <benchmark/benchmark.h>

#include "common/geometry/camera_mount.hpp"
#include "controller/core/controller.hpp"
#include "tests/support/synthetic_flat.hpp"

namespace lapis::controller {
namespace {

const geometry::PinholeCamera kCamera{640, 360, 320, 320, 319.5, 179.5};
const geometry::Pose kT_base_camera = geometry::T_base_camera({1.0, 0.0});
constexpr int kViews = 12;
constexpr double kTurn_rad = 2.0 * std::numbers::pi / kViews;

struct View {
  PlanarPose T_map_base;
  DepthView depth;
};

/// The robot turns once around in the first room, near its door.
const std::vector<View>& views() {
  static const std::vector<View> all = [] {
    std::vector<View> result;
    const auto flat = lapis::test::furnished_flat();
    for (int i = 0; i < kViews; ++i) {
      const auto image = lapis::test::render(flat, kCamera, lapis::test::look({7.0, 3.2, 1.0}, i * kTurn_rad));
      result.push_back({planar_pose({7.0, 3.2}, i * kTurn_rad), {image.depth, kCamera, kT_base_camera}});
    }
    return result;
  }();
  return all;
}

/// The mapper's grid of the same flat.
Grid grid() {
  Grid g{0.25, {0.0, 0.0}, 96, 52, std::vector<std::int8_t>(96 * 52, 0)};
  for (const auto& box : lapis::test::furnished_flat()) {
    if (box.high.z() < 0.2 || box.low.z() > 1.2) continue;
    for (double x = box.low.x(); x < box.high.x(); x += 0.1) {
      for (double y = box.low.y(); y < box.high.y(); y += 0.1) {
        if (x < 0.0 || y < 0.0 || x >= 24.0 || y >= 13.0) continue;
        g.cells[static_cast<std::size_t>(y / 0.25) * 96 + static_cast<std::size_t>(x / 0.25)] = 100;
      }
    }
  }
  return g;
}

LocalMap looked_around() {
  LocalMap map{{}};
  map.set_plan(grid());
  map.set_obstacles(grid());
  for (const View& view : views()) map.add(view.depth, view.T_map_base, time::Time{1}, true);
  return map;
}

void add_view(benchmark::State& state) {
  LocalMap map = looked_around();
  std::size_t i = 0;
  for (auto _ : state) {
    const View& view = views()[++i % kViews];
    map.add(view.depth, view.T_map_base, time::Time{1}, true);
  }
}
BENCHMARK(add_view)->Name("controller_add_view/640x360")->Unit(benchmark::kMicrosecond);

void points_near(benchmark::State& state) {
  const LocalMap map = looked_around();
  std::size_t points = 0;
  for (auto _ : state) points = map.near(views()[0].T_map_base, 1.75).obstacles.size();
  state.counters["points"] = static_cast<double>(points);
}
BENCHMARK(points_near)->Name("controller_points_near")->Unit(benchmark::kMicrosecond);

void choose(benchmark::State& state) {
  const LocalPlanner planner(PathFan({}, 0.2));
  const LocalMap map = looked_around();
  const Surroundings around = map.near(views()[0].T_map_base, planner.fan().reach_m());
  for (auto _ : state) benchmark::DoNotOptimize(planner.choose(around, {1.0, 0.0}, std::nullopt));
  state.counters["doubtful"] = static_cast<double>(around.unseen_feet.size());
}
BENCHMARK(choose)->Name("controller_choose")->Unit(benchmark::kMicrosecond);

/// A whole cycle of a robot in front of a door: image, obstacles, decision.
void cycle(benchmark::State& state) {
  Controller controller({}, {});
  controller.set_path({planar_pose({7.0, 3.2}, 0.0), planar_pose({12.0, 3.2}, 0.0)}, "");
  controller.set_plan(grid());
  time::Time now{1'000'000'000};
  const View& view = views()[0];
  for (auto _ : state) {
    now = now + time::Duration{66'666'667};
    controller.note_camera(now, now);
    controller.note_planner(now);
    controller.set_pose(view.T_map_base, now, now);
    controller.see(view.depth, now, now);
    state.PauseTiming();
    controller.set_obstacles(grid(), now, now);
    state.ResumeTiming();
    benchmark::DoNotOptimize(controller.step(now));
  }
}
BENCHMARK(cycle)->Name("controller_cycle/640x360")->Unit(benchmark::kMicrosecond);

void make_fan(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(PathFan({}, 0.2));
}
BENCHMARK(make_fan)->Name("controller_make_fan")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapis::controller
