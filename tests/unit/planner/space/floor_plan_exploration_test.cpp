// A robot explores recorded floor plans with what it sees around it: the parts of the planning space together.

#include <cmath>
#include <fstream>
#include <iostream>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "planner/core/space/line.hpp"
#include "planner/core/space/path_planner.hpp"
#include "planner/core/space/viewpoints.hpp"
#include "tests/support/test_data.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using mapping::kFree;
using mapping::kOccupied;

/// Truth: a picture of the PGM format P5; white is free, everything else a wall.
class FloorPlan {
 public:
  explicit FloorPlan(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::string line;
    std::stringstream header;
    for (int tokens = 0; tokens < 4 && std::getline(in, line);) {
      if (line.starts_with("#")) continue;
      header << line << ' ';
      std::istringstream words(line);
      for (std::string word; words >> word;) ++tokens;
    }
    std::string magic;
    header >> magic >> width >> height;
    pixels_.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    in.read(reinterpret_cast<char*>(pixels_.data()), static_cast<std::streamsize>(pixels_.size()));
    if (magic != "P5" || !in) throw std::runtime_error("cannot read " + file.string());
  }

  std::int8_t at(Cell c) const {
    if (c.x < 0 || c.y < 0 || c.x >= width || c.y >= height) return kOccupied;
    const std::uint8_t pixel = pixels_[static_cast<std::size_t>(height - 1 - c.y) * static_cast<std::size_t>(width) +
                                       static_cast<std::size_t>(c.x)];
    return pixel > 240 ? kFree : kOccupied;
  }

  int width = 0, height = 0;

 private:
  std::vector<std::uint8_t> pixels_;
};

/// Looks in all directions, up to `range` [cells].
void look_around(const FloorPlan& truth, Cell robot, int range, test::World& world) {
  const int rays = 8 * range;
  for (int i = 0; i < rays; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / rays;
    const Cell end = robot + Cell{static_cast<int>(std::lround(range * std::cos(angle))),
                                  static_cast<int>(std::lround(range * std::sin(angle)))};
    walk_line(robot, end, [&](Cell c, double) {
      world.map.set(c, truth.at(c));
      return truth.at(c) == kFree;
    });
  }
}

/// The cheapest viewpoint of all frontiers whose cell was not looked at before.
std::optional<Viewpoint> nearest_view(const test::World& world, const FrontierMap& frontiers, Cell robot,
                                      const std::set<Cell>& looked_at) {
  const CostTree paths = grow_cost_tree(world.grid, {}, {robot});
  std::optional<Viewpoint> best;
  for (const auto& [id, frontier] : frontiers.frontiers()) {
    const ViewpointResult views =
        sample_viewpoints(world.grid, paths, frontier, {.min_distance_m = 0.0, .max_distance_m = 0.8});
    for (const Viewpoint& view : views.viewpoints)
      if (!looked_at.contains(view.target) && (!best || view.cost_m < best->cost_m)) best = view;
  }
  return best;
}

struct PlanCase {
  const char* name;
  double resolution_m;
  Eigen::Vector2d start;  ///< from the lower left corner [m]
};

class FloorPlans : public testing::TestWithParam<PlanCase> {};

TEST_P(FloorPlans, AreExploredUntilNothingReachableIsLeft) {
  const auto file = lapis::test::find_test_data("maps2d/" + std::string(GetParam().name) + ".pgm");
  if (!file) GTEST_SKIP() << lapis::test::missing_test_data("maps2d");
  const FloorPlan truth(*file);
  const double resolution_m = GetParam().resolution_m;
  test::World known(resolution_m), world(resolution_m);
  for (Cell c; c.y < truth.height; ++c.y)
    for (c.x = 0; c.x < truth.width; ++c.x) known.map.set(c, truth.at(c));
  known.update();
  Cell robot = world.grid.cell_of(GetParam().start);
  ASSERT_TRUE(known.grid.is_traversable(robot)) << "start";
  const CostTree reachable = grow_cost_tree(known.grid, {}, {robot});
  FrontierMap frontiers({});
  std::set<Cell> looked_at;  // a failed view where they are frontiers still: rays pass by
  int looks = 0;
  for (; looks < 500; ++looks) {
    look_around(truth, robot, static_cast<int>(4.0 / resolution_m), world);
    frontiers.update(world.grid, world.update());
    const auto view = nearest_view(world, frontiers, robot, looked_at);
    if (!view) break;
    const PathResult path = find_path(world.grid, {}, robot, view->cell);
    ASSERT_EQ(path.status, PathStatus::kFound) << "a viewpoint that the cost tree reached";
    robot = view->cell;
    looked_at.insert(view->target);
  }
  EXPECT_LT(looks, 500) << "does not end";
  int all = 0, seen = 0;
  for (Cell c; c.y < truth.height; ++c.y) {
    for (c.x = 0; c.x < truth.width; ++c.x) {
      if (!reachable.cost_m(c)) continue;
      ++all;
      seen += world.grid.state(c) == kFree ? 1 : 0;
    }
  }
  std::cout << GetParam().name << ": " << looks << " looks, " << seen << " of " << all << " reachable cells\n";
  EXPECT_GE(seen, 0.99 * all);
}

INSTANTIATE_TEST_SUITE_P(Recorded, FloorPlans,
                         testing::Values(PlanCase{"aws_small_house", 0.05, {12.5, 12.5}},
                                         PlanCase{"nav2_tb3_sandbox", 0.05, {9.65, 8.15}}),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace lapis::planner
