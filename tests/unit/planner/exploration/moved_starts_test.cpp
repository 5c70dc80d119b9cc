// The robot starts anywhere, in any direction (F17, 100 seeds): exploration ends, what can be reached is known then,
// the robot never stands still for long, and a target that cannot be had is driven to three times at most.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "tests/unit/planner/exploration/walk_world.hpp"

namespace lapis::planner {
namespace {

using test::WalkWorld;
using Lines = std::vector<std::string>;

constexpr unsigned kSeeds = 100;
constexpr double kLongestIdleAnyStart_s = 10.0, kLongestRun_s = 900.0, kLeastShare = 0.98;

const std::vector<Lines> kWorlds = {
    {
        "#########################################",  //
        "#..........#............................#",  //
        "#..........#............................#",  //
        "#.......................................#",  //
        "#.......................................#",  //
        "#.......................................#",  //
        "#..........#............................#",  //
        "#..........#............................#",  //
        "#########################################",
    },
    {
        "#########################################",  //
        "#..........#.............##.............#",  //
        "#..........#.............##.............#",  //
        "#..........#............................#",  //
        "#.....................................###",  //
        "#.....................................###",  //
        "#.....................................###",  //
        "#..........#............................#",  //
        "#..........#............................#",  //
        "####...#####............................#",  //
        "#..........#####################....#####",  //
        "#..........#............................#",  //
        "#..........#............................#",  //
        "#..........#............................#",  //
        "#..........#............................#",  //
        "#########################################",
    },
    {
        "#########################",  // two rooms that cannot be entered
        "#...........#...........#",  //
        "#...........#...........#",  //
        "#...........W...........#",  //
        "#...........#...........#",  //
        "#...........#...........#",  //
        "#####...#################",  //
        "#...........#...........#",  //
        "#...........#...........#",  //
        "#...........#...........#",  //
        "#########################",
    },
};

/// A start drawn by seed, and what can be reached from there.
struct Start {
  explicit Start(unsigned seed) : lines(kWorlds[seed % kWorlds.size()]) {
    std::mt19937 random(seed);
    has_closed_rooms = seed % kWorlds.size() == 2;
    const auto below = [&](std::size_t end) { return static_cast<int>(random() % end); };
    do cell = {below(lines.front().size()), below(lines.size())};
    while (at(cell) != '.');
    yaw_rad = below(360) * std::numbers::pi / 180.0;
    std::vector<Cell> open{cell};
    reachable.insert(cell);
    while (!open.empty()) {
      const Cell from = open.back();
      open.pop_back();
      for (const Cell step : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
        if (at(from + step) == '.' && reachable.insert(from + step).second) open.push_back(from + step);
      }
    }
    at(cell) = 'R';
  }
  char& at(Cell c) { return lines[lines.size() - 1 - static_cast<std::size_t>(c.y)][static_cast<std::size_t>(c.x)]; }

  Lines lines;
  Cell cell{0, 0};
  double yaw_rad = 0.0;
  std::set<Cell> reachable;
  bool has_closed_rooms = false;
};

class MovedStart : public testing::TestWithParam<std::pair<std::string, unsigned>> {};

TEST_P(MovedStart, IsExploredToTheEnd) {
  const auto [method, seed] = GetParam();
  const Start start(seed);
  WalkWorld world(start.lines);
  world.robot.yaw_rad = start.yaw_rad;
  world.decision_config.method = make_method(method);
  world.explorer.start();
  world.run(kLongestRun_s);
  const bool may_give_up = start.has_closed_rooms && world.explorer.state() == State::kGaveUp;
  EXPECT_TRUE(may_give_up || world.explorer.state() == State::kDone) << world.explorer.reason();
  const auto known = std::count_if(start.reachable.begin(), start.reachable.end(),
                                   [&](Cell c) { return world.surroundings.grid().state(c) == mapping::kFree; });
  EXPECT_GE(static_cast<double>(known), kLeastShare * static_cast<double>(start.reachable.size()))
      << "from " << start.cell.x << ", " << start.cell.y;
  EXPECT_LE(world.longest_idle_s, kLongestIdleAnyStart_s);
  EXPECT_LE(world.most_failures(), test::kMostFailures);
  EXPECT_LE(world.most_failed_views(), test::kMostFailures);
}

std::vector<std::pair<std::string, unsigned>> starts(unsigned seeds) {
  std::vector<std::pair<std::string, unsigned>> all;
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    const std::string& other = method_names()[seed % method_names().size()];  // all worlds with all methods
    all.emplace_back("joint", seed);
    if (other != "joint") all.emplace_back(other, seed);
  }
  return all;
}

std::string name_of(const testing::TestParamInfo<std::pair<std::string, unsigned>>& start) {
  return start.param.first + '_' + std::to_string(start.param.second);
}

INSTANTIATE_TEST_SUITE_P(Seeds, MovedStart, testing::ValuesIn(starts(kSeeds)), name_of);

}  // namespace
}  // namespace lapis::planner
