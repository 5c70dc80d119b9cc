#include "simulator/core/generator/room_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace lapis::simulator {
namespace {

constexpr double kCell_m = 0.1;
constexpr double kRobot_m = 0.42;    // half the width that has to stay free: the validator demands 0.8 m
constexpr double kGap_m = 0.03;      // between items
constexpr double kFlat_m = 0.03;     // lower items are rugs, which are in nobody's way
constexpr double kOverhead_m = 1.4;  // the robot passes under what hangs higher
constexpr double kBeforeDoor_m = 0.95, kBeforeWindow_m = 0.35;
constexpr double kLeastShare = 0.25;        // of the floor that is reachable in the empty room
constexpr std::size_t kLargestPocket = 40;  // cells where the robot fits, but which it does not reach: 0.4 m2

}  // namespace

RoomSpace::RoomSpace(const Polygon& polygon, const std::vector<LocalOpening>& openings) : polygon_(polygon) {
  for (const auto& corner : polygon) bounds_.extend(corner);
  const Eigen::Vector2d size = bounds_.sizes();
  blocked_ = geometry::GrayImage(static_cast<int>(std::ceil(size.x() / kCell_m)),
                                 static_cast<int>(std::ceil(size.y() / kCell_m)));
  for (int row = 0; row < blocked_.height; ++row) {
    for (int column = 0; column < blocked_.width; ++column) {
      const Eigen::Vector2d p = bounds_.min() + kCell_m * Eigen::Vector2d(column + 0.5, row + 0.5);
      if (!contains(polygon, p) || distance_to_border(polygon, p) < kRobot_m - 0.05) blocked_(column, row) = 255;
    }
  }
  for (const LocalOpening& opening : openings) {
    const Eigen::Vector2d& start = polygon[opening.wall];
    const Eigen::Vector2d direction = (polygon[(opening.wall + 1) % polygon.size()] - start).normalized();
    const Eigen::Vector2d inward(-direction.y(), direction.x()), middle = start + opening.along_m * direction;
    const bool is_window = opening.kind == OpeningKind::kWindow;
    const double half = 0.5 * opening.width_m + (is_window ? 0.0 : 0.1);
    Eigen::AlignedBox2d zone(middle - half * direction);
    zone.extend(middle + half * direction);
    zone.extend(middle + (is_window ? kBeforeWindow_m : kBeforeDoor_m) * inward);
    if (is_window) {
      before_windows_.push_back({zone, opening.bottom_m + 0.02, std::numeric_limits<double>::infinity()});
      continue;
    }
    clear_.push_back(zone);
    if (opening.kind == OpeningKind::kLeaf) continue;
    const Eigen::Vector2d cell = (middle + 0.45 * inward - bounds_.min()) / kCell_m;
    doors_.emplace_back(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
  }
  bool reaches_all = false;
  most_cells_ = reachable(blocked_, reaches_all);
}

bool RoomSpace::add(const ItemBox& item) {
  if (meets_anything(item)) return false;
  if (item.top_m - item.bottom_m > kFlat_m && item.bottom_m < kOverhead_m) {
    geometry::GrayImage blocked = blocked_;
    block(blocked, item.area);
    bool reaches_all = false;
    const std::size_t cells = reachable(blocked, reaches_all);
    const auto free = static_cast<std::size_t>(std::count(blocked.pixels.begin(), blocked.pixels.end(), 0));
    if (!reaches_all || free - cells > kLargestPocket) return false;
    if (static_cast<double>(cells) < kLeastShare * static_cast<double>(most_cells_)) return false;
    blocked_ = std::move(blocked);
  }
  items_.push_back(item);
  return true;
}

bool RoomSpace::meets_anything(const ItemBox& item) const {
  const Polygon corners{item.area.min(),
                        {item.area.max().x(), item.area.min().y()},
                        item.area.max(),
                        {item.area.min().x(), item.area.max().y()}};
  if (!contains(polygon_, corners)) return true;
  if (item.top_m - item.bottom_m < kFlat_m) {  // a rug lies under things, but not on another rug
    return std::any_of(items_.begin(), items_.end(),
                       [&](const ItemBox& other) { return other.top_m < kFlat_m && other.area.intersects(item.area); });
  }
  const auto meets_area = [&](const Eigen::AlignedBox2d& zone) {
    return zone.intersection(item.area).sizes().minCoeff() > 0.0;
  };
  if (item.bottom_m < kOverhead_m + 0.7 && std::any_of(clear_.begin(), clear_.end(), meets_area)) return true;
  const auto hides = [&](const ItemBox& window) { return item.top_m > window.bottom_m && meets_area(window.area); };
  if (std::any_of(before_windows_.begin(), before_windows_.end(), hides)) return true;
  const Eigen::Vector2d gap(kGap_m, kGap_m);
  const Eigen::AlignedBox2d around(item.area.min() - gap, item.area.max() + gap);
  return std::any_of(items_.begin(), items_.end(), [&](const ItemBox& other) {
    return other.top_m > kFlat_m && other.bottom_m < item.top_m && item.bottom_m < other.top_m &&
           other.area.intersection(around).sizes().minCoeff() > 0.0;
  });
}

void RoomSpace::block(geometry::GrayImage& cells, const Eigen::AlignedBox2d& area) const {
  const Eigen::Vector2d low = (area.min() - bounds_.min()) / kCell_m, high = (area.max() - bounds_.min()) / kCell_m;
  const double reach = kRobot_m / kCell_m;
  for (int row = std::max(0, static_cast<int>(low.y() - reach)); row < cells.height && row <= high.y() + reach; ++row) {
    for (int column = std::max(0, static_cast<int>(low.x() - reach));
         column < cells.width && column <= high.x() + reach; ++column) {
      const Eigen::Vector2d p = bounds_.min() + kCell_m * Eigen::Vector2d(column + 0.5, row + 0.5);
      if (area.exteriorDistance(p) < kRobot_m) cells(column, row) = 255;
    }
  }
}

std::size_t RoomSpace::reachable(const geometry::GrayImage& blocked, bool& reaches_all_doors) const {
  geometry::GrayImage seen(blocked.width, blocked.height);
  std::vector<Eigen::Vector2i> open;
  const auto visit = [&](const Eigen::Vector2i& c) {
    if (c.x() < 0 || c.y() < 0 || c.x() >= blocked.width || c.y() >= blocked.height) return;
    if (blocked(c.x(), c.y()) != 0 || seen(c.x(), c.y()) != 0) return;
    seen(c.x(), c.y()) = 255;
    open.push_back(c);
  };
  if (doors_.empty()) {
    const auto free = std::find(blocked.pixels.begin(), blocked.pixels.end(), std::uint8_t{0});
    const auto index = static_cast<int>(free - blocked.pixels.begin());
    visit({index % blocked.width, index / blocked.width});
  } else {
    visit(doors_.front());
  }
  std::size_t next = 0;
  while (next < open.size()) {  // visit() appends to it
    const Eigen::Vector2i c = open[next++];
    for (const Eigen::Vector2i& step : std::array<Eigen::Vector2i, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}})
      visit(c + step);
  }
  reaches_all_doors = std::all_of(doors_.begin(), doors_.end(), [&](const Eigen::Vector2i& door) {
    return door.x() >= 0 && door.y() >= 0 && door.x() < seen.width && door.y() < seen.height &&
           seen(door.x(), door.y()) != 0;
  });
  return open.size();
}

}  // namespace lapis::simulator
