#include "simulator/core/robot/starts.hpp"

#include <algorithm>
#include <stdexcept>

#include "simulator/core/robot/regions.hpp"

namespace lapis::simulator {
namespace {

constexpr double kRoomAround_m = 0.2;  // between disc and obstacle

}  // namespace

std::vector<Cell> open_cells(const NavMap& map, double radius_m) {
  const Regions regions = find_regions(map.free_cells(radius_m + kRoomAround_m), Neighbours::kFour);
  if (regions.sizes.empty()) return {};
  const auto largest = std::max_element(regions.sizes.begin(), regions.sizes.end()) - regions.sizes.begin();
  std::vector<Cell> cells;
  for (int row = 0; row < regions.labels.height; ++row) {
    for (int column = 0; column < regions.labels.width; ++column) {
      if (regions.labels(column, row) == static_cast<std::uint32_t>(largest) + 1) cells.push_back({column, row});
    }
  }
  return cells;
}

std::vector<StartPose> starts_of(const Scene& scene, const NavMap& map, double radius_m) {
  if (!scene.starts.empty()) return scene.starts;
  const auto cells = open_cells(map, radius_m);
  if (cells.empty())
    throw std::runtime_error(
        "scene " + scene.name +
        ": the robot fits nowhere with 0.2 m of room; name starts, or try a smaller robot.radius_m");
  const auto most_open = std::max_element(cells.begin(), cells.end(),
                                          [&](Cell a, Cell b) { return map.distance_at(a) < map.distance_at(b); });
  return {{map.grid().center(*most_open), 0.0}};
}

}  // namespace lapis::simulator
