// mutual_information/ray: what a ray of a view costs, deduplication included, beside the same written plainly: a
// look-up in the map and an evaluation of every class for each cell. The map: apartment after half of its bundled tour,
// at true poses; 50 views of 2,304 rays, half of them from where the camera was and half from where it has yet to go.
// CPU time of one thread.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <numeric>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include "planner/core/information/path_information.hpp"
#include "tests/benchmark/planner/half_explored.hpp"
#include "tests/unit/planner/information/plain_information.hpp"

namespace lapis::planner {
namespace {

constexpr std::size_t kPoses = 50;
constexpr std::size_t kPosesPerPath = 10;

InformationField field_of(const mapping::VoxelMap& map) {
  InformationField field(map.resolution_m(), mapping::SensorModel{}, {Measure::kSemantic});
  field.rebuild(map);
  return field;
}

View view(double min_reach = ViewConfig{}.min_reach) {
  ViewConfig config;
  config.min_reach = min_reach;
  config.camera = robot::pinhole_camera(test::apartment().robot.camera);
  return View(config);
}

/// Evenly over the tour.
std::vector<ViewPath> single_views() {
  const auto& poses = test::tour().T_map_camera;
  std::vector<ViewPath> paths;
  for (std::size_t i = 0; i < kPoses; ++i) paths.push_back({poses[(2 * i + 1) * poses.size() / (2 * kPoses)]});
  return paths;
}

/// The same poses, ten in turn to a path.
std::vector<ViewPath> paths_of_ten() {
  std::vector<ViewPath> paths(kPoses / kPosesPerPath);
  const std::vector<ViewPath> views = single_views();
  for (std::size_t i = 0; i < views.size(); ++i) paths[i / kPosesPerPath].push_back(views[i].front());
  return paths;
}

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Times evaluate(path) for all paths; the time of an iteration is that of one ray.
template <class Evaluate>
void time_per_ray(benchmark::State& state, const View& view, const std::vector<ViewPath>& paths,
                  const Evaluate& evaluate) {
  double nats = 0.0;
  const auto rays = static_cast<double>(kPoses * view.directions().size());
  for (auto _ : state) {
    nats = 0.0;
    const double begin_s = cpu_s();
    for (const ViewPath& path : paths) nats += evaluate(path);
    state.SetIterationTime((cpu_s() - begin_s) / rays);
  }
  state.counters["rays"] = rays;
  state.counters["nats_per_view"] = nats / kPoses;
}

void rays(benchmark::State& state, double resolution_m, const std::vector<ViewPath>& paths, Counting counting) {
  const InformationField field = field_of(test::half_explored_map(resolution_m));
  const View rays_of_view = view(), rays_without_cut = view(0.0);
  time_per_ray(state, rays_of_view, paths,
               [&](const ViewPath& path) { return path_information(field, rays_of_view, path, counting); });
  double whole = 0.0;
  for (const ViewPath& path : paths) whole += path_information(field, rays_without_cut, path, counting);
  state.counters["lost_to_min_reach"] = 1.0 - state.counters["nats_per_view"] * kPoses / whole;
}

/// P(free) and gain of a voxel, class by class in the closed form of [Asgharivaskasi & Atanasov 2023], which lets
/// clamped beliefs gain, too.
class PlainCells {
 public:
  explicit PlainCells(const mapping::VoxelMap& map) : map_(map), reader_(mapping::SensorModel{}) {
    const std::vector<double> prior = reader_.class_log_odds({});
    const std::vector<double> hit = reader_.class_log_odds({0, {{1, mapping::kOneVote}}});
    const std::vector<double> miss = reader_.class_log_odds({mapping::kOneVote, {}});
    psi_ = hit[0] - prior[0];
    phi_hit_ = hit[1] - prior[1];
    phi_miss_ = miss[0] - prior[0];
  }

  CellInformation operator()(const mapping::VoxelIndex& voxel) const {
    const std::vector<double> odds = odds_of(map_.read(voxel));
    const double all = std::accumulate(odds.begin(), odds.end(), 0.0);
    const double s = 1.0 + all, missed = std::exp(phi_miss_) * all;
    double gain = std::log(s / (1.0 + missed)) + phi_miss_ * missed / (1.0 + missed);
    for (const double odd : odds) {
      const double others = std::exp(phi_hit_) * (all - odd), own = std::exp(psi_) * odd, after = 1.0 + others + own;
      gain += odd * (std::log(s / after) + (psi_ * own + phi_hit_ * others) / after);
    }
    return {1.0 / s, gain / s};
  }

 private:
  /// Of each class, clamped.
  std::vector<double> odds_of(const mapping::VoxelCounts& counts) const {
    std::vector<double> odds = reader_.class_probabilities(counts);
    const double p_free = odds.front();
    odds.erase(odds.begin());
    for (double& odd : odds) odd /= p_free;
    return odds;
  }

  const mapping::VoxelMap& map_;
  mapping::BeliefReader reader_;
  double psi_, phi_hit_, phi_miss_;
};

void plain_rays(benchmark::State& state, double resolution_m) {
  const mapping::VoxelMap map = test::half_explored_map(resolution_m);
  const PlainCells cells(map);
  const View rays_of_view = view();
  std::size_t cells_crossed = 0;
  time_per_ray(state, rays_of_view, single_views(), [&](const ViewPath& path) {
    return test::plain_path_information(rays_of_view, path, resolution_m, Counting::kOnce,
                                        [&](const mapping::VoxelIndex& voxel) {
                                          ++cells_crossed;
                                          return cells(voxel);
                                        });
  });
  state.counters["cells_per_ray"] = static_cast<double>(cells_crossed) / state.counters["rays"];
}

/// Renews every block of the map; the time of an iteration is that of one block.
void update(benchmark::State& state, double resolution_m) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const mapping::VoxelMap map = test::half_explored_map(resolution_m);
  InformationField field = field_of(map);
  const std::vector<mapping::BlockIndex> blocks = map.sorted_blocks();
  for (auto _ : state) {
    const double begin_s = cpu_s();
    field.update(map, blocks);
    state.SetIterationTime((cpu_s() - begin_s) / static_cast<double>(blocks.size()));
  }
  state.counters["blocks"] = static_cast<double>(blocks.size());
}

template <class Run>
void add(const std::string& name, int iterations, Run run) {
  benchmark::RegisterBenchmark(name.c_str(), run)->Iterations(iterations)->UseManualTime();
}

void register_all() {
  for (const double resolution_m : {0.25, 0.1}) {
    const double r = resolution_m;
    const std::string where = r == 0.25 ? "/0.25m" : "/0.10m";
    add("mutual_information/ray" + where, 20,
        [r](benchmark::State& s) { rays(s, r, single_views(), Counting::kOnce); });
    add("mutual_information/ray_of_path" + where, 20,
        [r](benchmark::State& s) { rays(s, r, paths_of_ten(), Counting::kOnce); });
    add("mutual_information/ray_counted_each" + where, 20,
        [r](benchmark::State& s) { rays(s, r, single_views(), Counting::kEveryRay); });
    add("mutual_information/plain_ray" + where, 1, [r](benchmark::State& s) { plain_rays(s, r); });
    add("information_field/block" + where, 5, [r](benchmark::State& s) { update(s, r); });
  }
}

}  // namespace
}  // namespace lapis::planner

int main(int argc, char** argv) {
  lapis::planner::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
