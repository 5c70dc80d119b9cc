#include "planner/core/space/path_planner.hpp"

#include <map>
#include <numbers>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "planner/core/space/alternative_paths.hpp"
#include "planner/core/space/line.hpp"
#include "tests/unit/planner/space/flat_map.hpp"

namespace lapis::planner {
namespace {

using mapping::kFree;
using mapping::kOccupied;
using test::TextWorld;
using test::World;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<Cell> line_cells(Cell from, Cell to) {
  std::vector<Cell> cells;
  walk_line(from, to, [&](Cell c, double) {
    cells.push_back(c);
    return true;
  });
  return cells;
}

/// True when a straight line between two centres, tried at many points, stays in traversable cells.
bool is_open(const PlanningGrid& grid, Cell from, Cell to) {
  const Eigen::Vector2d a = grid.center_of(from), b = grid.center_of(to);
  for (int i = 0; i <= 1000; ++i)
    if (!grid.is_traversable(grid.cell_of(a + (b - a) * (i / 1000.0)))) return false;
  return true;
}

bool is_open(const PlanningGrid& grid, const Path& path) {
  for (std::size_t i = 1; i < path.cells.size(); ++i)
    if (!is_open(grid, path.cells[i - 1], path.cells[i])) return false;
  return true;
}

TEST(WalkLine, VisitsWhatTheLineTouches) {
  EXPECT_THAT(line_cells({2, 3}, {2, 3}), ElementsAre(Cell{2, 3}));
  EXPECT_THAT(line_cells({0, 0}, {-3, 0}), ElementsAre(Cell{0, 0}, Cell{-1, 0}, Cell{-2, 0}, Cell{-3, 0}));
  EXPECT_THAT(line_cells({0, 0}, {1, 1}), ElementsAre(Cell{0, 0}, Cell{1, 0}, Cell{0, 1}, Cell{1, 1}));
  EXPECT_THAT(line_cells({0, 0}, {2, 1}), ElementsAre(Cell{0, 0}, Cell{1, 0}, Cell{1, 1}, Cell{2, 1}));
}

TEST(WalkLine, SharesAreThoseOfTheSampledLine) {
  for (int x = -7; x <= 7; ++x) {
    for (int y = -7; y <= 7; ++y) {
      std::map<Cell, double> share;
      walk_line({0, 0}, {x, y}, [&](Cell c, double s) {
        share[c] += s;
        return true;
      });
      constexpr int kSamples = 20'000;
      for (int i = 0; i < kSamples; ++i) {
        const double t = (i + 0.5) / kSamples;
        share[{static_cast<int>(std::floor(0.5 + t * x)), static_cast<int>(std::floor(0.5 + t * y))}] -= 1.0 / kSamples;
      }
      for (const auto& [cell, rest] : share) EXPECT_NEAR(rest, 0.0, 2.0 / kSamples) << x << ' ' << y;
    }
  }
}

World random_world(unsigned seed, int edge, int obstacles, double resolution_m) {
  World world(resolution_m);
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> place(0, edge - 1);
  for (Cell c; c.y < edge; ++c.y)
    for (c.x = 0; c.x < edge; ++c.x) world.map.set(c, kFree);
  for (int i = 0; i < obstacles; ++i) world.map.set({place(random), place(random)}, kOccupied);
  world.update();
  return world;
}

/// Costs by relaxing every step until nothing changes (Bellman-Ford), over traversable cells.
std::map<Cell, double> relaxed_costs(const PlanningGrid& grid, const PathConfig& config, Cell from, int edge) {
  std::map<Cell, double> cost{{from, 0.0}};
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (Cell c; c.y < edge; ++c.y) {
      for (c.x = 0; c.x < edge; ++c.x) {
        if (!cost.contains(c)) continue;
        for (int dx = -1; dx <= 1; ++dx) {
          for (int dy = -1; dy <= 1; ++dy) {
            const Cell n{c.x + dx, c.y + dy};
            if (!grid.is_traversable(n) || !grid.is_traversable({n.x, c.y}) || !grid.is_traversable({c.x, n.y}))
              continue;
            const double length = std::hypot(dx, dy) * grid.resolution_m();
            const double sum =
                cost[c] + 0.5 * length * (cost_per_metre(grid, config, c) + cost_per_metre(grid, config, n));
            const auto [known, is_new] = cost.emplace(n, sum);
            if (!is_new && sum >= known->second - 1e-12) continue;
            known->second = sum;
            has_changed = true;
          }
        }
      }
    }
  }
  return cost;
}

class RandomWorlds : public testing::TestWithParam<unsigned> {};

TEST_P(RandomWorlds, CostsAreTheLeast) {
  constexpr int kEdge = 24;
  const World world = random_world(GetParam(), kEdge, 12, 0.15);
  const PathConfig config;
  Cell from{kEdge / 2, kEdge / 2};
  while (!world.grid.is_traversable(from)) ++from.x;
  const std::map<Cell, double> expected = relaxed_costs(world.grid, config, from, kEdge);
  const CostTree tree = grow_cost_tree(world.grid, config, {from});
  int reached = 0;
  for (Cell c; c.y < kEdge; ++c.y) {
    for (c.x = 0; c.x < kEdge; ++c.x) {
      const auto cost = tree.cost_m(c);
      ASSERT_EQ(cost.has_value(), expected.contains(c));
      if (!cost) continue;
      ++reached;
      ASSERT_NEAR(*cost, expected.at(c), 1e-9);
      const CostTree to_goal = grow_cost_tree(world.grid, config, {from, c});  // A*
      ASSERT_NEAR(*to_goal.cost_m(c), expected.at(c), 1e-9);
      ASSERT_EQ(tree.path_to(c).front(), from);
      ASSERT_EQ(tree.path_to(c).back(), c);
    }
  }
  EXPECT_GT(reached, 50);
}

TEST_P(RandomWorlds, StraightenedPathsStayOpenAndCostNoMore) {
  constexpr int kEdge = 60;
  const World world = random_world(GetParam(), kEdge, 20, 0.1);
  const PathConfig config;
  std::mt19937 random(GetParam());
  std::uniform_int_distribution<int> place(0, kEdge - 1);
  int found = 0;
  for (int i = 0; i < 20; ++i) {
    const Cell from{place(random), place(random)}, to{place(random), place(random)};
    if (!world.grid.is_traversable(from)) continue;
    const PathResult result = find_path(world.grid, config, from, to);
    if (result.status != PathStatus::kFound) continue;
    ++found;
    EXPECT_EQ(result.path.cells.front(), from);
    EXPECT_EQ(result.path.cells.back(), to);
    EXPECT_TRUE(is_open(world.grid, result.path));
    const double cost_m = *grow_cost_tree(world.grid, config, {from, to}).cost_m(to);
    EXPECT_LE(result.path.cost_m, 1.001 * cost_m + 1e-9);
    EXPECT_GE(result.path.length_m, distance(from, to) * 0.1 - 1e-9);
    EXPECT_LE(result.path.length_m, result.path.cost_m + 1e-9);
  }
  EXPECT_GT(found, 3);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomWorlds, testing::Range(0u, 10u));

TEST(CostTree, StopsAtItsBound) {
  const World world = random_world(1, 40, 0, 0.25);
  const CostTree tree = grow_cost_tree(world.grid, {}, {{20, 20}, {}, 2.0});
  EXPECT_TRUE(tree.cost_m({28, 20}));
  EXPECT_FALSE(tree.cost_m({29, 20}));
  EXPECT_THAT(tree.path_to({29, 20}), IsEmpty());
}

const std::vector<std::string> kDoorOfTwo = {
    "############",  //
    "#....#.....#",  //
    "#A.........#",  //
    "#..........#",  //
    "#....#...B.#",  //
    "############",
};

TEST(FindPath, GoesThroughADoorOfTwoCells) {
  const TextWorld world(kDoorOfTwo);
  const PathResult result = find_path(world.grid, {}, world.places.at('A'), world.places.at('B'));
  ASSERT_EQ(result.status, PathStatus::kFound);
  EXPECT_TRUE(is_open(world.grid, result.path));
  EXPECT_LT(result.path.length_m, 2.3);
}

TEST(FindPath, AWideRobotDoesNotFitThroughIt) {
  GridConfig wide;
  wide.footprint_radius_m = 0.3;
  const TextWorld world(kDoorOfTwo, 0.25, wide);
  EXPECT_EQ(find_path(world.grid, {}, {2, 3}, {8, 2}).status, PathStatus::kNoPath);
  EXPECT_EQ(find_path(world.grid, {}, {2, 3}, {5, 3}).status, PathStatus::kGoalNotTraversable);
  EXPECT_EQ(find_path(world.grid, {}, {7, 3}, {9, 3}).status, PathStatus::kFound) << "has room behind the door";
}

TEST(FindPath, ADoorThatClosesBehind) {
  TextWorld world(kDoorOfTwo);
  const Cell a = world.places.at('A'), b = world.places.at('B');
  world.map.set({5, 2}, kOccupied);
  world.map.set({5, 3}, kOccupied);
  world.update();
  EXPECT_EQ(find_path(world.grid, {}, a, b).status, PathStatus::kNoPath);
  EXPECT_EQ(find_path(world.grid, {}, a, {5, 2}).status, PathStatus::kGoalNotTraversable);
}

TEST(FindPath, KeepsToTheMiddleOfACorridor) {
  const TextWorld world({std::string(60, '#'), std::string(60, '.'), std::string(60, '.'), std::string(60, '.'),
                         std::string(60, '.'), std::string(60, '.'), std::string(60, '.'), std::string(60, '.'),
                         std::string(60, '.'), std::string(60, '.'), std::string(60, '#')},
                        0.1);
  const PathResult result = find_path(world.grid, {}, {2, 3}, {57, 3});
  ASSERT_EQ(result.status, PathStatus::kFound);
  EXPECT_NEAR(world.grid.center_of(result.path.cells[1]).y(), 0.5, 0.11) << "0.5 m to either wall";
}

TEST(FindPath, LeavesAPlaceBesideAWall) {
  const TextWorld world({"############", "............", "............", "............", "............", "............",
                         "............", "............", "############"},
                        0.1);
  const Cell start{4, 1}, goal{8, 5};
  ASSERT_FALSE(world.grid.is_traversable(start));
  const PathResult result = find_path(world.grid, {}, start, goal);
  ASSERT_EQ(result.status, PathStatus::kFound);
  EXPECT_EQ(result.path.cells.front(), start);
  const std::vector<Cell> cells = grow_cost_tree(world.grid, {}, {start, goal}).path_to(goal);
  for (std::size_t i = 1; i < cells.size() && !world.grid.is_traversable(cells[i - 1]); ++i)
    EXPECT_GE(world.grid.clearance_m(cells[i]), world.grid.clearance_m(cells[i - 1]));
}

TEST(FindPath, LeavesUnknownAndOccupiedCells) {
  const TextWorld world(
      {"##########", "#........#", "#........#", "#...  ...#", "#...  ...#", "#......#.#", "##########"});
  EXPECT_EQ(find_path(world.grid, {}, {4, 2}, {1, 1}).status, PathStatus::kFound) << "from an unknown cell";
  EXPECT_EQ(find_path(world.grid, {}, {7, 1}, {1, 1}).status, PathStatus::kFound) << "from an occupied cell";
  PathConfig rooted;
  rooted.escape_m = 0.0;
  EXPECT_EQ(find_path(world.grid, rooted, {3, 2}, {1, 1}).status, PathStatus::kFound) << "a neighbour is traversable";
  const TextWorld lost(
      {"#####       #####", "#....       ....#", "#....       ....#", "#....       ....#", "#####       #####"});
  EXPECT_EQ(find_path(lost.grid, {.escape_m = 0.5}, {7, 2}, {1, 2}).status, PathStatus::kNoPath)
      << "1 m to a traversable cell";
  EXPECT_EQ(find_path(lost.grid, {}, {7, 2}, {1, 2}).status, PathStatus::kFound);
}

TEST(FindPath, LeadsBackOverWhatWasDrivenButNeverSeen) {
  TextWorld world(
      {"######           ######", "#A...#           #...B#", "#.....           .....#", "######           ######"});
  const Cell a = world.places.at('A'), b = world.places.at('B');
  EXPECT_EQ(find_path(world.grid, {}, b, a).status, PathStatus::kNoPath);
  for (double x_m = 1.0; x_m < 5.0; x_m += 0.05) world.grid.mark_driven({x_m, 0.25 + 0.05 * x_m});
  const PathResult result = find_path(world.grid, {}, b, a);
  ASSERT_EQ(result.status, PathStatus::kFound);
  EXPECT_EQ(result.path.cells.back(), a);
}

TEST(FindPath, NeverLeavesThroughAWall) {
  // The robot stands too near to a thin wall; the goal is beyond it, within the distance of an escape.
  const std::string open(40, '.'), wall(40, '#');
  const TextWorld world({wall, open, open, open, open, open, open, wall, open, open, open, open, open, open, wall},
                        0.1);
  const Cell start{20, 8}, goal{20, 4};
  ASSERT_FALSE(world.grid.is_traversable(start));
  ASSERT_TRUE(world.grid.is_traversable(goal));
  EXPECT_EQ(find_path(world.grid, {}, start, goal).status, PathStatus::kNoPath);
  EXPECT_EQ(find_path(world.grid, {}, start, {20, 10}).status, PathStatus::kFound);
}

TEST(PosesAlong, AreEquallySpacedAndHeadAlong) {
  const std::vector<Eigen::Vector2d> points{{0, 0}, {1, 0}, {1, 2.05}};
  const std::vector<Pose2> poses = poses_along(points, 0.5, -1.0);
  ASSERT_THAT(poses, SizeIs(8));  // 3.05 m in 7 parts
  EXPECT_EQ(poses.front().p_map, points.front());
  EXPECT_EQ(poses.back().p_map, points.back());
  EXPECT_EQ(poses.back().yaw_rad, -1.0);
  for (std::size_t i = 0; i + 1 < poses.size(); ++i) {
    const double s = 3.05 / 7 * static_cast<double>(i);
    EXPECT_NEAR(poses[i].p_map.x(), std::min(s, 1.0), 1e-12);
    EXPECT_NEAR(poses[i].p_map.y(), std::max(s - 1.0, 0.0), 1e-12);
    EXPECT_EQ(poses[i].yaw_rad, s < 1.0 ? 0.0 : std::numbers::pi / 2);
  }
}

TEST(PosesAlong, APointIsAPose) {
  const std::vector<Eigen::Vector2d> point{{3, 4}}, twice{{3, 4}, {3, 4}};
  EXPECT_THAT(poses_along(point, 0.5, 0.1), SizeIs(1));
  EXPECT_THAT(poses_along(twice, 0.5, 0.1), SizeIs(1));
  EXPECT_EQ(poses_along(twice, 0.5, 0.1)[0].yaw_rad, 0.1);
}

/// A square room with a square block in its middle: two paths round.
std::vector<std::string> room_with_block(std::size_t corridor, std::size_t block) {
  const std::size_t edge = 2 * corridor + block;
  std::vector<std::string> lines(edge + 2, '#' + std::string(edge, '.') + '#');
  lines.front() = lines.back() = std::string(edge + 2, '#');
  for (std::size_t row = 1 + corridor; row <= corridor + block; ++row)
    lines[row].replace(1 + corridor, block, block, '#');
  return lines;
}

TEST(FindAlternatives, GoesRoundABlockOnBothSides) {
  const TextWorld world(room_with_block(6, 12));
  const PathConfig config;
  const std::vector<Path> paths = find_alternatives(world.grid, config, {3, 12}, {22, 13}, 3);
  ASSERT_THAT(paths, SizeIs(2));
  for (const Path& path : paths) {
    EXPECT_TRUE(is_open(world.grid, path));
    EXPECT_EQ(path.cells.front(), (Cell{3, 12}));
    EXPECT_EQ(path.cells.back(), (Cell{22, 13}));
    EXPECT_LE(path.length_m, config.max_detour * paths.front().length_m);
  }
  const auto passes_above = [](const Path& path) {
    return std::any_of(path.cells.begin(), path.cells.end(), [](Cell c) { return c.y > 18; });
  };
  EXPECT_NE(passes_above(paths[0]), passes_above(paths[1]));
}

TEST(FindAlternatives, LeavesOutLongDetours) {
  const TextWorld world(room_with_block(6, 12));
  EXPECT_THAT(find_alternatives(world.grid, {}, {3, 8}, {22, 8}, 3), SizeIs(1)) << "the other path is twice as long";
  PathConfig patient;
  patient.max_detour = 3.0;
  EXPECT_THAT(find_alternatives(world.grid, patient, {3, 8}, {22, 8}, 2), SizeIs(2));
}

TEST(FindAlternatives, AnEmptyRoomHasOnePath) {
  const TextWorld world(room_with_block(15, 0));
  EXPECT_THAT(find_alternatives(world.grid, {}, {3, 15}, {27, 15}, 3), SizeIs(1));
}

TEST(FindAlternatives, ThreeCorridorsGiveThreePathsAndNoGoalNone) {
  std::vector<std::string> lines(23, '#' + std::string(40, '.') + '#');
  lines.front() = lines.back() = std::string(42, '#');
  for (const std::size_t wall : {6u, 7u, 8u, 14u, 15u, 16u})
    lines[wall] = '#' + std::string(6, '.') + std::string(28, '#') + std::string(6, '.') + '#';
  const TextWorld world(lines);
  const std::vector<Path> paths = find_alternatives(world.grid, {}, {3, 11}, {38, 11}, 3);
  ASSERT_THAT(paths, SizeIs(3));
  std::set<int> corridors;
  for (const Path& path : paths) {
    EXPECT_TRUE(is_open(world.grid, path));
    for (std::size_t i = 1; i < path.cells.size(); ++i)
      for (const Cell& c : line_cells(path.cells[i - 1], path.cells[i]))
        if (c.x == 20) corridors.insert(c.y / 8);
  }
  EXPECT_THAT(corridors, SizeIs(3));
  EXPECT_THAT(find_alternatives(world.grid, {}, {3, 11}, {20, 7}, 3), IsEmpty());
}

}  // namespace
}  // namespace lapis::planner
