// A hundred flats drawn at random, with starts anywhere in them: in all of them exploration ends, almost all that can
// be reached is known then, the robot never stands still for long, and a target that cannot be had is driven to three
// times at most (F17). Some rooms are closed, some are behind glass.
#include <gtest/gtest.h>

#include <random>
#include <set>

#include "tests/unit/planner/exploration/walk_world.hpp"

namespace lapis::planner {
namespace {

using test::WalkWorld;

constexpr int kSeeds = 100;
constexpr int kSmallestRoom = 6, kDoor = 3;  // [cells]
constexpr double kLongestIdle_s = 10.0, kLongestRun_s = 1800.0;

struct Room {
  int x0, y0, x1, y1;  ///< first and last cell
};

/// Rooms in rooms: each is divided by a wall with a door, a pane of glass or nothing in it until it is small.
class DrawnFlat {
 public:
  explicit DrawnFlat(unsigned seed) : random_(seed) {
    const int width = between(24, 40), height = between(16, 28);
    lines_.assign(static_cast<std::size_t>(height), std::string(static_cast<std::size_t>(width), '#'));
    const Room whole{1, 1, width - 2, height - 2};
    for (int y = whole.y0; y <= whole.y1; ++y)
      for (int x = whole.x0; x <= whole.x1; ++x) at(x, y) = '.';
    divide(whole);
    furnish(whole);
    place_robot(whole);
  }

  const std::vector<std::string>& lines() const { return lines_; }
  /// Floor that the robot can drive to, by row and column of lines().
  std::set<Cell> reachable() const {
    std::set<Cell> found{robot_};
    std::vector<Cell> open{robot_};
    while (!open.empty()) {
      const Cell c = open.back();
      open.pop_back();
      for (const Cell step : {Cell{1, 0}, Cell{-1, 0}, Cell{0, 1}, Cell{0, -1}}) {
        const Cell next = c + step;
        if (lines_[static_cast<std::size_t>(next.y)][static_cast<std::size_t>(next.x)] == '.' &&
            found.insert(next).second)
          open.push_back(next);
      }
    }
    return found;
  }
  double yaw_rad() { return between(0, 359) * std::numbers::pi / 180.0; }

 private:
  char& at(int x, int y) { return lines_[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]; }
  int between(int low, int high) { return low + static_cast<int>(random_() % static_cast<unsigned>(high - low + 1)); }

  void divide(const Room& room) {
    const bool is_wide = room.x1 - room.x0 > room.y1 - room.y0;
    const int first = is_wide ? room.x0 : room.y0, last = is_wide ? room.x1 : room.y1;
    if (last - first < 2 * kSmallestRoom) return;
    const int wall = between(first + kSmallestRoom, last - kSmallestRoom);
    const int across0 = is_wide ? room.y0 : room.x0, across1 = is_wide ? room.y1 : room.x1;
    const auto cell = [&](int along) -> char& { return is_wide ? at(wall, along) : at(along, wall); };
    if (cell(across0 - 1) != '#' || cell(across1 + 1) != '#') return;  // there is a door
    for (int i = across0; i <= across1; ++i) cell(i) = '#';
    const int kind = between(0, 9);
    const char filling = kind == 0 ? '#' : kind == 1 ? 'W' : kind == 2 ? 'G' : '.';
    const int door = between(across0, across1 - kDoor + 1);
    for (int i = door; i < door + kDoor; ++i) cell(i) = filling;
    divide(is_wide ? Room{room.x0, room.y0, wall - 1, room.y1} : Room{room.x0, room.y0, room.x1, wall - 1});
    divide(is_wide ? Room{wall + 1, room.y0, room.x1, room.y1} : Room{room.x0, wall + 1, room.x1, room.y1});
  }
  void furnish(const Room& whole) {
    for (int i = between(0, 6); i > 0; --i) {
      const int x = between(whole.x0, whole.x1 - 1), y = between(whole.y0, whole.y1 - 1);
      for (const Cell c : {Cell{x, y}, Cell{x + 1, y}, Cell{x, y + 1}, Cell{x + 1, y + 1}})
        if (at(c.x, c.y) == '.') at(c.x, c.y) = '#';
    }
  }
  void place_robot(const Room& whole) {
    do robot_ = {between(whole.x0, whole.x1), between(whole.y0, whole.y1)};
    while (at(robot_.x, robot_.y) != '.');
    at(robot_.x, robot_.y) = 'R';
  }

  std::mt19937 random_;
  std::vector<std::string> lines_;
  Cell robot_{0, 0};
};

class ManyWorlds : public testing::TestWithParam<int> {};

TEST_P(ManyWorlds, AreExploredToTheEnd) {
  DrawnFlat flat(static_cast<unsigned>(GetParam()));
  WalkWorld world(flat.lines());
  world.robot.yaw_rad = flat.yaw_rad();
  world.explorer.start();
  world.run(kLongestRun_s);
  std::string drawing;
  for (const auto& line : flat.lines()) drawing += line + '\n';
  EXPECT_EQ(world.explorer.state(), State::kDone) << world.explorer.reason() << '\n' << drawing;
  const auto reachable = flat.reachable();
  const auto rows = static_cast<int>(flat.lines().size());
  const auto known = std::count_if(reachable.begin(), reachable.end(), [&](Cell c) {
    return world.surroundings.grid().state({c.x, rows - 1 - c.y}) == mapping::kFree;
  });
  EXPECT_GE(static_cast<double>(known), 0.98 * static_cast<double>(reachable.size())) << drawing;
  EXPECT_LE(world.longest_idle_s, kLongestIdle_s) << drawing;
  EXPECT_LE(world.most_failures(), 3) << drawing;
}

INSTANTIATE_TEST_SUITE_P(Seeds, ManyWorlds, testing::Range(1, kSeeds + 1));

}  // namespace
}  // namespace lapis::planner
