#include "simulator/core/robot/reachability.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "simulator/core/robot/grid_steps.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

/// Calls visit(cell) for all cells whose centre lies in the polygon.
template <class Visit>
void for_cells_in(const std::vector<Eigen::Vector2d>& polygon, const Grid& grid, Visit visit) {
  if (polygon.empty()) return;
  Eigen::AlignedBox2d box;
  for (const auto& corner : polygon) box.extend(corner);
  const Cell low = grid.cell_of(box.min()), high = grid.cell_of(box.max());
  for (int row = low.row; row <= high.row; ++row) {
    for (int column = low.column; column <= high.column; ++column) {
      if (contains(polygon, grid.center({column, row}))) visit(Cell{column, row});
    }
  }
}

std::optional<Cell> most_open_cell(const NavMap& map, const Room& room) {
  std::optional<Cell> best;
  for_cells_in(room.polygon, map.grid(), [&](Cell c) {
    if (map.distance_at(c) > (best ? map.distance_at(*best) : 0.0)) best = c;
  });
  return best;
}

/// Joins cells in the order of decreasing distance from obstacles, and notes where groups that contain rooms meet.
class PassageFinder {
 public:
  PassageFinder(const NavMap& map, const std::vector<Room>& rooms)
      : map_(map), rooms_(rooms), free_(map.free_cells(0.0)), parent_(free_.pixels.size(), kNone) {
    for (std::size_t i = 0; i < rooms.size(); ++i) {
      middles_.push_back(most_open_cell(map, rooms[i]));
      if (middles_[i]) seeds_.emplace_back(index_of(*middles_[i]), i);
    }
    std::sort(seeds_.begin(), seeds_.end());
  }

  std::vector<Passage> find() {
    for (const std::size_t index : open_cells_first()) {
      parent_[index] = index;
      const Cell c = cell_at(index);
      for (const Cell step : std::span(kGridSteps).first(4)) {
        const Cell next{c.column + step.column, c.row + step.row};
        if (is_set(free_, next) && parent_[index_of(next)] != kNone) join(index, index_of(next), c);
      }
    }
    return std::move(passages_);
  }

 private:
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::size_t index_of(Cell c) const {
    return static_cast<std::size_t>(c.row) * static_cast<std::size_t>(free_.width) + static_cast<std::size_t>(c.column);
  }
  Cell cell_at(std::size_t index) const {
    const auto width = static_cast<std::size_t>(free_.width);
    return {static_cast<int>(index % width), static_cast<int>(index / width)};
  }
  std::vector<std::size_t> open_cells_first() const {
    std::vector<std::size_t> cells;
    for (std::size_t i = 0; i < free_.pixels.size(); ++i) {
      if (free_.pixels[i] != 0) cells.push_back(i);
    }
    std::stable_sort(cells.begin(), cells.end(), [&](std::size_t a, std::size_t b) {
      return map_.distance_at(cell_at(a)) > map_.distance_at(cell_at(b));
    });
    return cells;
  }
  std::size_t root(std::size_t index) {
    while (parent_[index] != index) index = parent_[index] = parent_[parent_[index]];
    return index;
  }
  std::optional<std::size_t> nearest_room(std::size_t group, const Eigen::Vector2d& at) {
    std::optional<std::size_t> best;
    double best_m = std::numeric_limits<double>::infinity();
    for (const auto& [index, room] : seeds_) {
      if (parent_[index] == kNone || root(index) != group) continue;
      const double distance = (map_.grid().center(*middles_[room]) - at).norm();
      if (distance < best_m) best = room;
      best_m = std::min(best_m, distance);
    }
    return best;
  }
  void join(std::size_t a, std::size_t b, Cell at) {
    const std::size_t first = root(a), second = root(b);
    if (first == second) return;
    const Eigen::Vector2d p = map_.grid().center(at);
    const auto from = nearest_room(first, p), to = nearest_room(second, p);
    if (from && to) passages_.push_back({rooms_[*from].id, rooms_[*to].id, 2.0 * map_.distance_at(at), p});
    parent_[std::max(first, second)] = std::min(first, second);
  }

  const NavMap& map_;
  const std::vector<Room>& rooms_;
  geometry::GrayImage free_;
  std::vector<std::size_t> parent_;  ///< union-find over cells; kNone: not visited yet
  std::vector<std::optional<Cell>> middles_;
  std::vector<std::pair<std::size_t, std::size_t>> seeds_;  ///< cell and room
  std::vector<Passage> passages_;
};

}  // namespace

std::vector<RoomReach> room_reach(const NavMap& map, const std::vector<Room>& rooms, const Eigen::Vector2d& start,
                                  double radius_m) {
  const geometry::GrayImage reachable = map.reachable(start, radius_m);
  const double cell_m2 = map.grid().resolution_m * map.grid().resolution_m;
  std::vector<RoomReach> out;
  for (const auto& room : rooms) {
    std::size_t all = 0, reached = 0;
    for_cells_in(room.polygon, map.grid(), [&](Cell c) {
      ++all;
      if (is_set(reachable, c)) ++reached;
    });
    const double share = all == 0 ? 0.0 : static_cast<double>(reached) / static_cast<double>(all);
    out.push_back({room.id, static_cast<double>(all) * cell_m2, share});
  }
  return out;
}

std::vector<Passage> passages(const NavMap& map, const std::vector<Room>& rooms) {
  return PassageFinder(map, rooms).find();
}

}  // namespace lapis::simulator
