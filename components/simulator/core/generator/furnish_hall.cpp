#include "simulator/core/generator/furnish_hall.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lapis::simulator {
namespace {

constexpr double kBetweenRacks_m = 0.04, kCrossAisle_m = 2.2, kPallet_m = 1.1, kBelowCeiling_m = 0.8;

/// A rectangle of the hall, and the direction of the rows of racks in it.
struct Field {
  Eigen::AlignedBox2d area;
  bool is_along_y = false;

  double length_m() const { return area.sizes()[is_along_y ? 1 : 0]; }
  double depth_m() const { return area.sizes()[is_along_y ? 0 : 1]; }
  Eigen::Vector2d at(double along_m, double across_m) const {
    return area.min() + (is_along_y ? Eigen::Vector2d(across_m, along_m) : Eigen::Vector2d(along_m, across_m));
  }
  /// Yaw of a rack whose front looks towards smaller values of `across`.
  int yaw_deg() const { return is_along_y ? 270 : 0; }
};

/// Properties that all racks of one hall have in common.
struct RackStyle {
  Article rack;
  double aisle_m = 2.4;
  bool is_double = false;  ///< two rows, back to back
  int blocks = 1;          ///< number of blocks into which cross aisles divide a row
};

RackStyle draw_style(RoomFurnisher& room, double length_m) {
  RackStyle style{room.any(Stock::kRacks)};
  style.rack.height_m = room.dice()(2.0, std::min(4.0, room.height_m() - kBelowCeiling_m));
  style.aisle_m = room.dice()(1.7, 3.2);
  style.is_double = room.dice().chance(0.5);
  style.blocks = room.dice().whole(1, length_m > 16.0 ? 3 : length_m > 8.0 ? 2 : 1);
  return style;
}

/// Adds a row of racks from `from` to `to`; some places stay empty.
void add_row(RoomFurnisher& room, const Field& field, const RackStyle& style, double from, double to, double across) {
  const Article& rack = style.rack;
  for (double x = from + 0.5 * rack.width_m; x + 0.5 * rack.width_m <= to; x += rack.width_m + kBetweenRacks_m) {
    if (room.dice().chance(0.06)) continue;
    room.at(rack, field.at(x, across + 0.5 * rack.depth_m), field.yaw_deg());
    if (!style.is_double) continue;
    const double behind = across + 1.5 * rack.depth_m + kBetweenRacks_m;
    room.at(rack, field.at(x, behind), (field.yaw_deg() + 180) % 360);
  }
}

void add_racks(RoomFurnisher& room, const Field& field) {
  const RackStyle style = draw_style(room, field.length_m());
  const double thick = style.is_double ? 2.0 * style.rack.depth_m + kBetweenRacks_m : style.rack.depth_m;
  const double block = (field.length_m() - (style.blocks - 1) * kCrossAisle_m) / style.blocks;
  for (double across = 0.0; across + thick <= field.depth_m(); across += thick + style.aisle_m) {
    for (int i = 0; i < style.blocks; ++i) {
      const double from = i * (block + kCrossAisle_m);
      add_row(room, field, style, from, from + block, across);
    }
  }
}

/// Adds pallets side by side on the floor.
void add_pallets(RoomFurnisher& room, const Eigen::AlignedBox2d& yard) {
  const Article& goods = room.any(Stock::kPallets);
  const int columns = room.dice().whole(1, 4), rows = room.dice().whole(1, 2), yaw_deg = 90 * room.dice().whole(0, 3);
  const Eigen::Vector2d size = kPallet_m * Eigen::Vector2d(columns, rows), free = yard.sizes() - size;
  if (free.minCoeff() < 0.0) return;
  const double x = room.dice()(0.0, free.x()), y = room.dice()(0.0, free.y());
  for (int i = 0; i < columns * rows; ++i) {
    if (room.dice().chance(0.15)) continue;
    const int column = i % columns, row = i / columns;
    const Eigen::Vector2d place(column + 0.5, row + 0.5);
    room.at(goods, yard.min() + Eigen::Vector2d(x, y) + kPallet_m * place, yaw_deg);
  }
}

/// The side of a box that has most loading doors: 0 to 3 for south, east, north and west.
std::size_t side_of_gates(const RoomFurnisher& room, const Eigen::AlignedBox2d& box) {
  std::array<int, 4> gates{};
  for (const LocalOpening& opening : room.openings()) {
    if (opening.kind != OpeningKind::kLeaf) continue;
    const Eigen::Vector2d p = room.place_of(opening);
    const std::array<double, 4> distances{p.y() - box.min().y(), box.max().x() - p.x(), box.max().y() - p.y(),
                                          p.x() - box.min().x()};
    ++gates[static_cast<std::size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin())];
  }
  return static_cast<std::size_t>(std::max_element(gates.begin(), gates.end()) - gates.begin());
}

/// Cuts a strip off one side of a box, and returns it.
Eigen::AlignedBox2d cut_off(Eigen::AlignedBox2d& box, std::size_t side, double depth_m) {
  const int axis = side % 2 == 0 ? 1 : 0;
  Eigen::AlignedBox2d strip = box;
  if (side == 0 || side == 3) {
    strip.max()[axis] = box.min()[axis] += depth_m;
  } else {
    strip.min()[axis] = box.max()[axis] -= depth_m;
  }
  return strip;
}

}  // namespace

void furnish_hall(RoomFurnisher& room) {
  Eigen::AlignedBox2d free;
  for (const auto& corner : room.polygon()) free.extend(corner);
  Dice& dice = room.dice();
  const double shorter = free.sizes().minCoeff();
  const Eigen::AlignedBox2d yard = cut_off(free, side_of_gates(room, free), dice(0.2, 0.4) * shorter);
  // On every side, either an aisle remains free or racks stand at the wall.
  for (std::size_t side = 0; side < 4; ++side) cut_off(free, side, dice.chance(0.4) ? 0.05 : dice(1.6, 2.2));
  const int blocks = std::max(2, static_cast<int>(yard.volume() / 14.0));
  if (dice.chance(0.85)) {
    add_racks(room, {free, dice.chance(0.5)});
  } else {
    for (int i = 0; i < static_cast<int>(free.volume() / 14.0); ++i) add_pallets(room, free);
  }
  for (int i = 0; i < blocks; ++i) add_pallets(room, yard);
  for (int i = 0; i < dice.whole(2, 5); ++i) room.against_wall(room.any(Stock::kGoods));
  for (int i = 0; i < dice.whole(0, 2); ++i) room.against_wall(room.any(Stock::kStores));
  if (const auto counter = room.against_wall(room.any(Stock::kCounters)))
    room.on(*counter, room.any(Stock::kScreens), {0.0, 0.12});
}

}  // namespace lapis::simulator
