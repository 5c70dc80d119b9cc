#include "planner/core/information/path_information.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/unit/planner/information/paper_model.hpp"
#include "tests/unit/planner/information/plain_information.hpp"
#include "tests/unit/planner/information/random_map.hpp"

namespace lapis::planner {
namespace {

using geometry::Pose;
using mapping::BeliefReader;
using mapping::kOneVote;
using mapping::SensorModel;
using mapping::VoxelCounts;
using mapping::VoxelIndex;
using mapping::VoxelMap;

constexpr double kResolution_m = 0.25;
constexpr int kClasses = 40;

ViewConfig view_config(int columns, int rows, double range_m) {
  ViewConfig config;
  config.camera = {641, 361, 320.0, 320.0, 320.0, 180.0};
  config.columns = columns;
  config.rows = rows;
  config.range_m = range_m;
  return config;
}

/// One ray, along the optical axis.
View ray_of_length(double range_m) {
  ViewConfig config = view_config(1, 1, range_m);
  config.min_reach = 0.0;
  return View(config);
}

template <class Real>
BasicInformationField<Real> field_of(const VoxelMap& map, const RayModel& ray = {}) {
  BasicInformationField<Real> field(map.resolution_m(), SensorModel{}, ray);
  field.rebuild(map);
  return field;
}

// Equation 13, and no return, term by term -----------------------------------------------------------------------

struct CrossedCell {
  double enter_m;
  VoxelIndex voxel;
};

/// Cells that a ray crosses, by a slab test of every voxel around it. Nothing when a chord is too short to decide.
std::vector<CrossedCell> cells_by_slabs(const Eigen::Vector3d& start, const Eigen::Vector3d& direction,
                                        double range_m) {
  std::vector<CrossedCell> cells;
  const VoxelIndex first = VoxelMap(kResolution_m).index_of(start);
  const int most = static_cast<int>(range_m / kResolution_m) + 2;
  for (int z = -most; z <= most; ++z)
    for (int y = -most; y <= most; ++y)
      for (int x = -most; x <= most; ++x) {
        const VoxelIndex voxel{first.x + x, first.y + y, first.z + z};
        double enter = 0.0, leave = range_m;
        const std::int32_t low[] = {voxel.x, voxel.y, voxel.z};
        for (int axis = 0; axis < 3; ++axis) {
          const double a = (low[axis] * kResolution_m - start[axis]) / direction[axis];
          const double b = ((low[axis] + 1) * kResolution_m - start[axis]) / direction[axis];
          enter = std::max(enter, std::min(a, b));
          leave = std::min(leave, std::max(a, b));
        }
        if (std::abs(leave - enter) < 1e-7) return {};
        if (enter < leave) cells.push_back({enter, voxel});
      }
  std::sort(cells.begin(), cells.end(), [](auto& a, auto& b) { return a.enter_m < b.enter_m; });
  return cells;
}

/// h of eq. 14, as corrected: KL of the belief after one more vote from the belief before.
double h(const BeliefReader& reader, const VoxelCounts& before, const VoxelCounts& after) {
  const std::vector<double> p = reader.class_probabilities(before), q = reader.class_probabilities(after);
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += q[i] * std::log(q[i] / p[i]);
  return sum;
}

VoxelCounts with_hit(const VoxelCounts& counts, std::uint16_t label) {
  std::map<std::uint16_t, std::uint32_t> hits;
  for (const auto& hit : counts.hits) hits[hit.label] = hit.count;
  hits[label] += kOneVote;
  VoxelCounts after{counts.misses, {}};
  for (const auto& [id, count] : hits) after.hits.push_back({id, count});
  return after;
}

/// Sum over all outcomes (cell and class of the hit, or no return) of probability times information.
double equation_13(const BeliefReader& reader, const VoxelMap& map, const std::vector<CrossedCell>& cells) {
  double sum = 0.0, p_passed_all = 1.0, passed_information = 0.0;
  for (const CrossedCell& cell : cells) {
    const VoxelCounts counts = map.read(cell.voxel);
    const std::vector<double> p = reader.class_probabilities(counts);
    for (int c = 1; c <= reader.model().class_count; ++c) {
      const VoxelCounts after = with_hit(counts, static_cast<std::uint16_t>(c));
      sum += p_passed_all * p[static_cast<std::size_t>(c)] * (passed_information + h(reader, counts, after));
    }
    p_passed_all *= p[0];
    passed_information += h(reader, counts, {counts.misses + kOneVote, counts.hits});
  }
  return sum + p_passed_all * passed_information;
}

TEST(PathInformation, OfARayIsEquation13) {
  std::mt19937 random(13);
  const BeliefReader reader{SensorModel{}};
  const double range_m = 3.0;
  const View view = ray_of_length(range_m);
  int compared = 0;
  for (int i = 0; i < 8; ++i) {
    const VoxelMap map = test::random_map(random, kResolution_m, kClasses);
    const auto exact = field_of<double>(map);
    const auto field = field_of<float>(map);
    for (int ray = 0; ray < 15; ++ray) {
      const Pose pose = test::random_pose(random, 2.5);
      const auto cells = cells_by_slabs(pose.translation(), pose.linear().col(2), range_m);
      if (cells.empty()) continue;
      ++compared;
      const double expected = equation_13(reader, map, cells);
      EXPECT_NEAR(path_information(exact, view, {pose}), expected, 1e-6 * expected);
      EXPECT_NEAR(path_information(field, view, {pose}), expected, 1e-3 * expected);
    }
  }
  EXPECT_GT(compared, 110);
}

TEST(PathInformation, OfARayHasThePapersValues) {
  const std::vector<double> unknown(4, -0.1);
  const auto cell_of = [](const std::vector<double>& chi) {
    return CellMeasure(test::paper_model_with_prior(chi), {Measure::kSemantic}).of({});
  };
  const auto ray = [&](const std::vector<CellInformation>& first_cells, std::size_t length) {
    BasicInformationField<double> field(kResolution_m, test::paper_model_with_prior(unknown), {Measure::kSemantic});
    for (std::size_t first = 0; first < first_cells.size(); first += mapping::kBlockEdge) {
      std::vector<CellInformation> cells(mapping::kBlockVoxels, cell_of(unknown));
      for (std::size_t i = first; i < std::min<std::size_t>(first + mapping::kBlockEdge, first_cells.size()); ++i)
        cells[i - first] = first_cells[i];
      field.set_block({static_cast<int>(first) / mapping::kBlockEdge, 0, 0},
                      std::span<const CellInformation, mapping::kBlockVoxels>(cells));
    }
    // From the middle of the first cell to that of the last one, along x.
    Pose pose = Pose::Identity();
    pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    pose.translation().setConstant(0.5 * kResolution_m);
    return path_information(field, ray_of_length((static_cast<double>(length) - 1.0) * kResolution_m), {pose});
  };
  EXPECT_NEAR(ray({}, 40), 0.127120706, 1e-9);
  EXPECT_NEAR(ray(std::vector(12, cell_of(std::vector(4, -3.0 - std::log(4.0)))), 40), 0.078005879, 1e-9);
  std::vector<CellInformation> object(5, cell_of(std::vector(4, -9.21024)));
  object.push_back(cell_of({2.0, -1.0, -3.0, -2.0}));
  EXPECT_NEAR(ray(object, 16), 0.055123202, 1e-9);
}

// Views and paths ------------------------------------------------------------------------------------------------

ViewPath random_path(std::mt19937& random, std::size_t poses) {
  ViewPath path;
  while (path.size() < poses) path.push_back(test::random_pose(random, 2.5));
  return path;
}

TEST(PathInformation, EqualsAPlainTableOfCells) {
  std::mt19937 random(17);
  for (int trial = 0; trial < 10; ++trial) {
    ViewConfig config = view_config(24, 14, 4.0);
    config.min_reach = trial % 2 == 0 ? 0.0 : 1e-2;
    const View view(config);
    const VoxelMap map = test::random_map(random, kResolution_m, kClasses);
    const ViewPath path = random_path(random, 4);
    for (const Measure measure : {Measure::kSemantic, Measure::kShannon, Measure::kCsqmi}) {
      const auto exact = field_of<double>(map, {measure});
      const auto field = field_of<float>(map, {measure});
      for (const Counting counting : {Counting::kOnce, Counting::kEveryRay}) {
        const double expected = test::plain_path_information(view, path, kResolution_m, counting,
                                                             [&](const VoxelIndex& v) { return exact.cell(v); });
        EXPECT_NEAR(path_information(exact, view, path, counting), expected, 1e-9 * expected);
        EXPECT_NEAR(path_information(field, view, path, counting), expected, 1e-3 * expected);
      }
    }
  }
}

TEST(PathInformation, LosesLittleWhereRaysEndEarly) {
  std::mt19937 random(31);
  ViewConfig config = view_config(24, 14, 10.0);
  const View view(config);
  config.min_reach = 0.0;
  const View whole(config);
  for (int trial = 0; trial < 10; ++trial) {
    const auto field = field_of<double>(test::random_map(random, kResolution_m, kClasses));
    const ViewPath path = random_path(random, 4);
    const double expected = path_information(field, whole, path);
    EXPECT_LE(path_information(field, view, path), expected);
    EXPECT_NEAR(path_information(field, view, path), expected, 1e-3 * expected);
  }
}

TEST(PathInformation, EveryRayIsTheSumOfRays) {
  std::mt19937 random(19);
  const auto field = field_of<double>(test::random_map(random, kResolution_m, kClasses));
  ViewConfig config = view_config(8, 5, 4.0);
  config.min_reach = 0.0;
  const View view(config), ray = ray_of_length(4.0);
  const Pose pose = test::random_pose(random, 1.0);
  double sum = 0.0;
  for (const Eigen::Vector3d& direction : view.directions()) {
    Pose T_camera_ray = Pose::Identity();
    T_camera_ray.linear() = Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), direction).matrix();
    sum += path_information(field, ray, {pose * T_camera_ray});
  }
  EXPECT_NEAR(path_information(field, view, {pose}, Counting::kEveryRay), sum, 1e-9 * sum);
}

TEST(PathInformation, HidesWhatIsBehindAWall) {
  VoxelMap map(kResolution_m);
  mapping::VoxelBlock wall;
  for (int offset = 0; offset < mapping::kBlockVoxels; ++offset) wall.add_hit(offset, 3, 100 * kOneVote);
  for (int z = -3; z < 3; ++z)
    for (int y = -3; y < 3; ++y) map.set_block({0, y, z}, wall);
  Pose pose = Pose::Identity();  // looks along x, 1 m before the wall
  pose.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pose.translation() << -1.01, 0.01, 0.01;
  const auto field = field_of<float>(map);
  const auto nats = [&](double range_m) {
    return path_information(field, View(view_config(16, 9, range_m)), {pose}, Counting::kEveryRay);
  };
  EXPECT_GT(nats(0.9), 1.0);
  EXPECT_NEAR(nats(8.0), nats(2.5), 1e-2 * nats(2.5));
}

TEST(PathInformation, ObeysItsLaws) {
  std::mt19937 random(23);
  const View view(view_config(24, 14, 4.0));
  for (int trial = 0; trial < 10; ++trial) {
    const auto field = field_of<float>(test::random_map(random, kResolution_m, kClasses));
    ViewPath path;
    double before = 0.0;
    for (const Pose& pose : random_path(random, 5)) {
      path.push_back(pose);
      const double now = path_information(field, view, path);
      EXPECT_GE(now, before * (1.0 - 1e-6)) << "one more pose cannot lower it";
      EXPECT_LE(now, before + path_information(field, view, {pose}) * (1.0 + 1e-6));
      EXPECT_LE(now, path_information(field, view, path, Counting::kEveryRay) * (1.0 + 1e-6));
      before = now;
    }
    EXPECT_GT(before, 0.0);
    const std::vector<double> growing = growing_information(field, view, path);
    ASSERT_EQ(growing.size(), path.size());
    for (std::size_t i = 0; i < path.size(); ++i) {
      const ViewPath first(path.begin(), path.begin() + static_cast<std::ptrdiff_t>(i) + 1);
      EXPECT_NEAR(growing[i], path_information(field, view, first), 1e-6 * before);
    }
    std::shuffle(path.begin(), path.end(), random);
    EXPECT_EQ(path_information(field, view, path), before) << "the order of poses";
    path.push_back(path.front());
    EXPECT_EQ(path_information(field, view, path), before) << "a pose twice";
  }
  EXPECT_EQ(path_information(field_of<float>(VoxelMap(kResolution_m)), view, ViewPath{}), 0.0);
}

TEST(PathInformation, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(29);
  const View view(view_config(24, 14, 4.0));
  const VoxelMap map = test::random_map(random, kResolution_m, kClasses);
  std::vector<ViewPath> paths;
  for (std::size_t i = 0; i < 24; ++i) paths.push_back(random_path(random, 1 + i % 4));
  const auto with_threads = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    return path_information(field_of<float>(map), view, paths);
  };
  const std::vector<double> one = with_threads(1);
  for (const std::size_t threads : {2u, 3u, 8u}) EXPECT_EQ(with_threads(threads), one);
  for (std::size_t i = 0; i < paths.size(); ++i)
    EXPECT_EQ(path_information(field_of<float>(map), view, paths[i]), one[i]);
}

TEST(PathInformation, RefusesPosesThatAreNotValid) {
  const auto field = field_of<float>(VoxelMap(kResolution_m));
  Pose pose = Pose::Identity();
  pose.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(path_information(field, View(view_config(4, 4, 2.0)), {pose}), std::invalid_argument);
}

TEST(View, HasARayInTheMiddleOfEachPartOfTheImage) {
  const ViewConfig config = view_config(64, 36, 10.0);
  const View view(config);
  ASSERT_EQ(view.directions().size(), 64u * 36u);
  EXPECT_NEAR(view.directions()[0].norm(), 1.0, 1e-12);
  const Eigen::Vector2d first = config.camera.project(view.directions().front());
  const Eigen::Vector2d last = config.camera.project(view.directions().back());
  EXPECT_NEAR(first.x(), 641.0 / 128 - 0.5, 1e-9);
  EXPECT_NEAR(first.y(), 361.0 / 72 - 0.5, 1e-9);
  EXPECT_NEAR(last.x(), 640.5 - 641.0 / 128, 1e-9);
}

TEST(View, RefusesValuesOutOfRange) {
  const auto with = [](auto change) {
    ViewConfig config = view_config(4, 4, 5.0);
    change(config);
    return View(config);
  };
  EXPECT_THROW(with([](ViewConfig& c) { c.camera.fx = 0.0; }), std::runtime_error);
  EXPECT_THROW(with([](ViewConfig& c) { c.columns = 0; }), std::runtime_error);
  EXPECT_THROW(with([](ViewConfig& c) { c.rows = 5000; }), std::runtime_error);
  EXPECT_THROW(with([](ViewConfig& c) { c.range_m = 0.0; }), std::runtime_error);
  EXPECT_THROW(with([](ViewConfig& c) { c.min_reach = 1.0; }), std::runtime_error);
}

}  // namespace
}  // namespace lapis::planner
