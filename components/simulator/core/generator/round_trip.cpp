#include "simulator/core/generator/round_trip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>

#include "common/geometry/image.hpp"
#include "simulator/core/generator/floor_drawing.hpp"
#include "simulator/core/robot/grid.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

constexpr double kFloorCell_m = 0.1, kRobotRadius_m = 0.3;
constexpr double kPlaceSpacing_m = 5.0;  // in large rooms
constexpr double kEnough_m = 0.9;        // more distance from obstacles makes a place no better
constexpr double kStartRoom_m = 0.45;    // free distance around a start
constexpr double kLow_m = 1.3;           // the robot passes under what hangs higher
constexpr std::size_t kStarts = 5;

using Distances = geometry::Image<float>;

/// The floor plan as cells, with their distances to the nearest obstacle.
class FloorGrid {
 public:
  explicit FloorGrid(const SceneSpec& spec) {
    Eigen::AlignedBox2d bounds;
    for (const RoomSpec& room : spec.rooms) {
      for (const auto& corner : room.polygon) bounds.extend(corner);
    }
    grid_.origin = bounds.min();
    grid_.resolution_m = kFloorCell_m;
    grid_.width = static_cast<int>(std::ceil(bounds.sizes().x() / kFloorCell_m));
    grid_.height = static_cast<int>(std::ceil(bounds.sizes().y() / kFloorCell_m));
    geometry::GrayImage blocked(grid_.width, grid_.height);
    std::fill(blocked.pixels.begin(), blocked.pixels.end(), std::uint8_t{255});
    for (const RoomSpec& room : spec.rooms) fill(blocked, room.polygon, 0);
    for (const OpeningSpec& opening : spec.openings) {
      if (opening.kind != OpeningKind::kDoor && opening.kind != OpeningKind::kPassage) continue;
      fill(blocked, rectangle(opening.at, hole_of(spec, opening), 0.0), 0);
    }
    for (const FurnitureSpec& item : spec.furniture) {
      const auto* place = std::get_if<AtPoint>(&item.place);
      if (place == nullptr || item.size_m->z() < 0.03 || item.elevation_m.value_or(0.0) > kLow_m) continue;
      fill(blocked, rectangle(place->at, item.size_m->head<2>(), place->yaw_rad), 255);
    }
    measure(blocked);
  }

  const Grid& grid() const { return grid_; }
  double distance_m(Cell c) const { return distance_(c.column, c.row); }
  bool is_free(Cell c) const { return grid_.contains(c) && distance_m(c) >= kRobotRadius_m; }

  /// Lengths of the shortest paths from one cell, in cells; -1 where there is no path.
  geometry::Image<int> lengths_from(Cell from) const {
    geometry::Image<int> lengths(grid_.width, grid_.height);
    std::fill(lengths.pixels.begin(), lengths.pixels.end(), -1);
    lengths(from.column, from.row) = 0;
    std::deque<Cell> open{from};
    for (; !open.empty(); open.pop_front()) {
      const Cell c = open.front();
      for (const Cell step : std::array<Cell, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}}) {
        const Cell next{c.column + step.column, c.row + step.row};
        if (!is_free(next) || lengths(next.column, next.row) >= 0) continue;
        lengths(next.column, next.row) = lengths(c.column, c.row) + 1;
        open.push_back(next);
      }
    }
    return lengths;
  }

 private:
  /// Extents along x and y of the hole of a door, for walls along x or y [m].
  static Eigen::Vector2d hole_of(const SceneSpec& spec, const OpeningSpec& opening) {
    const double through = spec.wall_thickness_m + 2.0 * kFloorCell_m;
    for (const RoomSpec& room : spec.rooms) {
      for (std::size_t i = 0; i < room.polygon.size(); ++i) {
        const Eigen::Vector2d &a = room.polygon[i], &b = room.polygon[(i + 1) % room.polygon.size()];
        const int axis = std::abs(b.x() - a.x()) > std::abs(b.y() - a.y()) ? 0 : 1;
        const bool is_near = std::abs(opening.at[1 - axis] - a[1 - axis]) < spec.wall_thickness_m;
        if (!is_near || opening.at[axis] < std::min(a[axis], b[axis]) || opening.at[axis] > std::max(a[axis], b[axis]))
          continue;
        return axis == 0 ? Eigen::Vector2d(opening.width_m, through) : Eigen::Vector2d(through, opening.width_m);
      }
    }
    return {through, through};
  }

  void fill(geometry::GrayImage& cells, const Polygon& polygon, std::uint8_t value) const {
    Eigen::AlignedBox2d box;
    for (const auto& corner : polygon) box.extend(corner);
    const Cell low = grid_.cell_of(box.min()), high = grid_.cell_of(box.max());
    for (int row = low.row; row <= high.row; ++row) {
      for (int column = low.column; column <= high.column; ++column) {
        if (contains(polygon, grid_.center({column, row}))) cells(column, row) = value;
      }
    }
  }

  /// Distances between centres of cells, up to kEnough_m, by brute force over a disc.
  void measure(const geometry::GrayImage& blocked) {
    distance_ = Distances(grid_.width, grid_.height);
    const int reach = static_cast<int>(kEnough_m / kFloorCell_m) + 1;
    for (int row = 0; row < grid_.height; ++row) {
      for (int column = 0; column < grid_.width; ++column) {
        int nearest = reach * reach;
        for (int y = -reach; y <= reach; ++y) {
          for (int x = -reach; x <= reach; ++x) {
            const Cell c{column + x, row + y};
            if (!grid_.contains(c) || blocked(c.column, c.row) != 0) nearest = std::min(nearest, x * x + y * y);
          }
        }
        distance_(column, row) = static_cast<float>(kFloorCell_m * std::sqrt(nearest));
      }
    }
  }

  Grid grid_;
  Distances distance_;
};

/// For each square of about kPlaceSpacing_m of a room, the free cell near its middle with most room around it.
std::vector<Cell> places_in(const FloorGrid& floor, const Polygon& polygon) {
  Eigen::AlignedBox2d box;
  for (const auto& corner : polygon) box.extend(corner);
  const auto count = [](double length) { return std::max(1, static_cast<int>(std::lround(length / kPlaceSpacing_m))); };
  const int columns = count(box.sizes().x()), rows = count(box.sizes().y());
  const Eigen::Vector2d size = box.sizes().cwiseQuotient(Eigen::Vector2d(columns, rows));
  std::vector<Cell> places;
  for (int i = 0; i < columns * rows; ++i) {
    const Eigen::Vector2d low = box.min() + Eigen::Vector2d(i % columns, i / columns).cwiseProduct(size);
    const Eigen::Vector2d middle = low + 0.5 * size;
    const Cell first = floor.grid().cell_of(low), last = floor.grid().cell_of(low + size);
    std::optional<Cell> best;
    double most = -std::numeric_limits<double>::infinity();
    for (int row = first.row; row <= last.row; ++row) {
      for (int column = first.column; column <= last.column; ++column) {
        const Cell c{column, row};
        const Eigen::Vector2d p = floor.grid().center(c);
        const double value = std::min(floor.distance_m(c), kEnough_m) - 0.1 * (p - middle).norm();
        if (value <= most || !floor.is_free(c) || !contains(polygon, p)) continue;
        most = value;
        best = c;
      }
    }
    if (best) places.push_back(*best);
  }
  return places;
}

/// The heading with the longest free line, in steps of 45 degrees.
double longest_view_rad(const FloorGrid& floor, Cell from) {
  double best_rad = 0.0, longest = -1.0;
  for (int i = 0; i < 8; ++i) {
    const double yaw = 0.25 * std::numbers::pi * i;
    const Eigen::Vector2d direction(std::cos(yaw), std::sin(yaw)), p = floor.grid().center(from);
    double length = 0.0;
    while (length < 30.0) {
      const Eigen::Vector2d q = p + length * direction;
      const Cell c = floor.grid().cell_of(q);
      if ((floor.grid().center(c) - q).norm() > kFloorCell_m || floor.distance_m(c) < kFloorCell_m) break;
      length += kFloorCell_m;
    }
    if (length <= longest + 1e-9) continue;
    longest = length;
    best_rad = yaw;
  }
  return best_rad;
}

Eigen::Vector2d point(const FloorGrid& floor, Cell c) {
  const Eigen::Vector2d p = floor.grid().center(c);
  return {cm(p.x()) + 0.0, cm(p.y()) + 0.0};
}

/// Index of a place from which the robot reaches more than half of all places; failing that, of the one with most.
std::size_t central_place(const FloorGrid& floor, const std::vector<Cell>& places) {
  std::size_t best = 0, most = 0;
  for (std::size_t i = 0; i < places.size() && 2 * most <= places.size(); ++i) {
    const auto lengths = floor.lengths_from(places[i]);
    const auto count = static_cast<std::size_t>(
        std::count_if(places.begin(), places.end(), [&](Cell c) { return lengths(c.column, c.row) >= 0; }));
    if (count <= most) continue;
    most = count;
    best = i;
  }
  return best;
}

/// All places that can be reached from a central one, in driving order: the next one is the nearest that is left.
std::vector<Cell> in_driving_order(const FloorGrid& floor, std::vector<Cell> places) {
  std::swap(places.front(), places[central_place(floor, places)]);
  std::vector<Cell> order{places.front()};
  places.erase(places.begin());
  while (!places.empty()) {
    const auto lengths = floor.lengths_from(order.back());
    const auto length_to = [&](Cell c) {
      const int length = lengths(c.column, c.row);
      return length < 0 ? std::numeric_limits<int>::max() : length;
    };
    const auto next =
        std::min_element(places.begin(), places.end(), [&](Cell a, Cell b) { return length_to(a) < length_to(b); });
    if (length_to(*next) == std::numeric_limits<int>::max()) break;
    order.push_back(*next);
    places.erase(next);
  }
  return order;
}

}  // namespace

RoundTrip plan_round_trip(const SceneSpec& spec, const Random& random) {
  const FloorGrid floor(spec);
  std::vector<Cell> places;
  for (const RoomSpec& room : spec.rooms) {
    const auto found = places_in(floor, room.polygon);
    places.insert(places.end(), found.begin(), found.end());
  }
  if (places.empty()) throw std::runtime_error("building " + spec.name + ": the robot fits nowhere");
  const std::vector<Cell> order = in_driving_order(floor, places);
  for (const RoomSpec& room : spec.rooms) {
    const auto is_in_room = [&](Cell c) { return contains(room.polygon, floor.grid().center(c)); };
    if (std::none_of(order.begin(), order.end(), is_in_room))
      throw std::runtime_error("building " + spec.name + ": no waypoint of the tour is in " + room.id);
  }
  RoundTrip trip;
  for (const Cell c : order) trip.waypoints.push_back(point(floor, c));
  trip.waypoints.push_back(trip.waypoints.front());
  std::vector<Cell> open;
  std::copy_if(order.begin(), order.end(), std::back_inserter(open),
               [&](Cell c) { return floor.distance_m(c) >= kStartRoom_m; });
  const std::size_t count = std::min(kStarts, open.size());
  for (std::size_t i = 0; i < count; ++i) {
    // One start in each fifth of the tour.
    const std::size_t first = i * open.size() / count, last = (i + 1) * open.size() / count;
    const std::size_t pick = first + random.bits(i) % (last - first);
    trip.starts.push_back({point(floor, open[pick]), longest_view_rad(floor, open[pick])});
  }
  return trip;
}

}  // namespace lapis::simulator
