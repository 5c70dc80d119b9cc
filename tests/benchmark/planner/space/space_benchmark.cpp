// CPU time of the planning space, one thread: a building of 2000 x 2000 cells (100 m x 100 m at 0.05 m) of which half
// the rooms are known. A map delta is what becomes known (and unknown again, the next time) in a square.

#include <memory>
#include <random>

#include <benchmark/benchmark.h>

#include "planner/core/space/alternative_paths.hpp"
#include "planner/core/space/viewpoints.hpp"
#include "tests/unit/planner/space/flat_map.hpp"
#include "tests/unit/planner/space/frontier_rescan.hpp"

namespace lapis::planner {
namespace {

using mapping::kFree;
using mapping::kOccupied;
using mapping::kUnknown;

constexpr int kEdge = 2000, kRoom = 100;
constexpr double kResolution_m = 0.05;
constexpr Cell kStart{1050, 1050};  // in a room that is known

/// Rooms of 5 m x 5 m with doors of 0.9 m in all walls and pillars inside.
std::int8_t truth(Cell c) {
  const int x = c.x % kRoom, y = c.y % kRoom;
  const auto is_door = [](int along) { return along >= 41 && along < 59; };
  if ((x < 2 && !is_door(y)) || (y < 2 && !is_door(x))) return kOccupied;
  return (x / 4 == 6 || x / 4 == 18) && (y / 4 == 6 || y / 4 == 18) ? kOccupied : kFree;
}

/// Half of the rooms at random, and those around the start.
bool is_known(int room_x, int room_y) {
  if (std::abs(room_x - kStart.x / kRoom) <= 1 && std::abs(room_y - kStart.y / kRoom) <= 1) return true;
  return mapping::mix_bits(static_cast<std::uint64_t>(room_y) << 32 | static_cast<std::uint64_t>(room_x)) % 2 == 0;
}

struct Building {
  Building() : world(kResolution_m), states(kEdge, kEdge, kUnknown) {
    for (int y = 0; y < kEdge / kRoom; ++y)
      for (int x = 0; x < kEdge / kRoom; ++x)
        if (is_known(x, y)) reveal({x * kRoom, y * kRoom}, kRoom);
    frontiers.update(world.grid, update());
  }

  void reveal(Cell low, int edge) {
    for (Cell c{0, low.y}; c.y < low.y + edge; ++c.y)
      for (c.x = low.x; c.x < low.x + edge; ++c.x) world.map.set(c, truth(c));
  }
  void hide(Cell low, int edge) {
    for (Cell c{0, low.y}; c.y < low.y + edge; ++c.y)
      for (c.x = low.x; c.x < low.x + edge; ++c.x) world.map.set(c, kUnknown);
  }
  std::vector<Cell> update() {
    std::vector<Cell> changed = world.update();
    for (const Cell& c : changed) states(c.x, c.y) = world.grid.state(c);
    return changed;
  }

  test::World world;
  geometry::Image<std::int8_t> states;  ///< the same as a plain array, for the rescan
  FrontierMap frontiers{FrontierConfig{}};
};

Building& building() {
  static const auto instance = std::make_unique<Building>();
  return *instance;
}

/// Corner of an unknown room beside a known one, so that deltas join and part frontiers.
Cell unknown_room() {
  for (int y = 5; y < kEdge / kRoom; ++y)
    for (int x = 1; x < kEdge / kRoom; ++x)
      if (!is_known(x, y) && is_known(x - 1, y)) return {x * kRoom, y * kRoom};
  return {};
}

/// Square of `edge` cells, known and unknown in turn; leaves it unknown.
class Deltas {
 public:
  explicit Deltas(int edge) : edge_(edge), low_(unknown_room() + Cell{0, 40}) {}
  ~Deltas() {
    if (!is_known_) return;
    flip();
    building().frontiers.update(building().world.grid, building().update());
  }
  Deltas(const Deltas&) = delete;
  Deltas& operator=(const Deltas&) = delete;

  void flip() {
    is_known_ ? building().hide(low_, edge_) : building().reveal(low_, edge_);
    is_known_ = !is_known_;
  }

 private:
  int edge_;
  Cell low_;
  bool is_known_ = false;
};

/// Projection, change list and clearance.
void grid_update(benchmark::State& state) {
  Deltas deltas(static_cast<int>(state.range(0)));
  test::World& world = building().world;
  for (auto _ : state) {
    state.PauseTiming();
    deltas.flip();
    const std::vector<mapping::BlockIndex> blocks = world.map.flush();
    state.ResumeTiming();
    const std::vector<Cell> changed = world.grid.update_map(world.map.map(), world.reader, blocks);
    state.PauseTiming();
    for (const Cell& c : changed) building().states(c.x, c.y) = world.grid.state(c);
    building().frontiers.update(world.grid, changed);
    state.ResumeTiming();
  }
}

void clearance_update(benchmark::State& state) {
  Deltas deltas(static_cast<int>(state.range(0)));
  Building& b = building();
  SparseGrid<std::int8_t> states(kUnknown);
  DistanceField field(kOccupied, 20);
  std::vector<Cell> all;
  for (Cell c; c.y < kEdge; ++c.y) {
    for (c.x = 0; c.x < kEdge; ++c.x) {
      states.set(c, b.states(c.x, c.y));
      all.push_back(c);
    }
  }
  field.update(states, all);
  for (auto _ : state) {
    state.PauseTiming();
    deltas.flip();
    const std::vector<Cell> changed = b.update();
    b.frontiers.update(b.world.grid, changed);
    for (const Cell& c : changed) states.set(c, b.world.grid.state(c));
    state.ResumeTiming();
    field.update(states, changed);
  }
}

void clearance_from_scratch(benchmark::State& state) {
  Building& b = building();
  SparseGrid<std::int8_t> states(kUnknown);
  std::vector<Cell> all;
  for (Cell c; c.y < kEdge; ++c.y) {
    for (c.x = 0; c.x < kEdge; ++c.x) {
      states.set(c, b.states(c.x, c.y));
      all.push_back(c);
    }
  }
  for (auto _ : state) {
    DistanceField field(kOccupied, 20);
    field.update(states, all);
    benchmark::DoNotOptimize(field.squared(kStart));
  }
}

void frontier_update(benchmark::State& state) {
  Deltas deltas(static_cast<int>(state.range(0)));
  Building& b = building();
  std::size_t cells = 0;
  for (auto _ : state) {
    state.PauseTiming();
    deltas.flip();
    const std::vector<Cell> changed = b.update();
    cells += changed.size();
    state.ResumeTiming();
    b.frontiers.update(b.world.grid, changed);
  }
  state.counters["changed_cells"] = benchmark::Counter(static_cast<double>(cells), benchmark::Counter::kAvgIterations);
}

/// The plain way: all cells of the array, all frontiers anew.
void frontier_rescan(benchmark::State& state) {
  Building& b = building();
  std::size_t groups = 0;
  for (auto _ : state)
    groups = test::FrontierRescan(b.states, FrontierConfig{}.max_extent_m / kResolution_m).groups.size();
  if (groups != b.frontiers.frontiers().size()) state.SkipWithError("not the frontiers of the incremental map");
  state.counters["frontiers"] = static_cast<double>(groups);
}

/// Cost to all cells within a bound.
void cost_tree(benchmark::State& state) {
  Building& b = building();
  const auto bound_m = static_cast<double>(state.range(0));
  for (auto _ : state) {
    const CostTree tree = grow_cost_tree(b.world.grid, {}, {kStart, {}, bound_m});
    benchmark::DoNotOptimize(tree.cost_m(kStart));
  }
}

/// From room to room.
void a_star(benchmark::State& state) {
  Building& b = building();
  const Cell goal = kStart + Cell{kRoom, kRoom};
  for (auto _ : state) {
    const PathResult result = find_path(b.world.grid, {}, kStart, goal);
    if (result.status != PathStatus::kFound) state.SkipWithError("no path");
    benchmark::DoNotOptimize(result.path.length_m);
  }
}

void alternatives(benchmark::State& state) {
  Building& b = building();
  std::size_t found = 0;
  for (auto _ : state) found = find_alternatives(b.world.grid, {}, kStart, kStart + Cell{kRoom, kRoom}, 3).size();
  state.counters["paths"] = static_cast<double>(found);
}

/// Of every frontier within 15 m.
void viewpoints(benchmark::State& state) {
  Building& b = building();
  const CostTree tree = grow_cost_tree(b.world.grid, {}, {kStart, {}, 20.0});
  std::size_t frontiers = 0, views = 0;
  for (auto _ : state) {
    frontiers = views = 0;
    for (const auto& [id, frontier] : b.frontiers.frontiers()) {
      if (distance(frontier.representatives[0], kStart) * kResolution_m > 15.0) continue;
      ++frontiers;
      views += sample_viewpoints(b.world.grid, tree, frontier, {}).viewpoints.size();
    }
  }
  state.counters["frontiers"] = static_cast<double>(frontiers);
  state.counters["viewpoints"] = static_cast<double>(views);
}

BENCHMARK(grid_update)->Arg(20)->Arg(40)->Arg(55)->Unit(benchmark::kMicrosecond);
BENCHMARK(clearance_update)->Arg(20)->Arg(40)->Arg(55)->Unit(benchmark::kMicrosecond);
BENCHMARK(clearance_from_scratch)->Unit(benchmark::kMicrosecond);
BENCHMARK(frontier_update)->Arg(20)->Arg(40)->Arg(55)->Unit(benchmark::kMicrosecond);
BENCHMARK(frontier_rescan)->Unit(benchmark::kMicrosecond);
BENCHMARK(cost_tree)->Arg(5)->Arg(20)->Arg(200)->Unit(benchmark::kMillisecond);
BENCHMARK(a_star)->Unit(benchmark::kMillisecond);
BENCHMARK(alternatives)->Unit(benchmark::kMillisecond);
BENCHMARK(viewpoints)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lapis::planner

BENCHMARK_MAIN();
