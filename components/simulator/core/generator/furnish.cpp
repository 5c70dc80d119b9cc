#include "simulator/core/generator/furnish.hpp"

#include <numbers>
#include <string>

namespace lapis::simulator {
namespace {

using Index = std::optional<std::size_t>;

void add_on_table(RoomFurnisher& room, std::size_t table, bool has_screen) {
  const double width_m = room.item(table).article.width_m;
  if (has_screen) room.on(table, room.any(Stock::kScreens), {0.0, 0.12});
  const double side = 0.5 * width_m - 0.25;
  room.on(table, room.any(Stock::kDeskThings), {side, 0.05});
  if (room.dice().chance(0.5)) room.on(table, room.any(Stock::kDeskThings), {-side, -0.05});
}

/// A desk at a wall with a chair before it.
void add_desk(RoomFurnisher& room) {
  const Index desk = room.against_wall(room.any(Stock::kDesks));
  if (!desk) return;
  add_on_table(room, *desk, true);
  if (const Index chair = room.before(*desk, room.any(Stock::kDeskChairs), 0.06)) room.set_movable(*chair);
  room.hang_above(*desk, room.dice().chance(0.4) ? "board_panel" : "picture", {0.9, 0.6}, 1.6);
}

/// A table with chairs along its long sides.
void add_table(RoomFurnisher& room, Stock tables, Stock chairs) {
  const Article& article = room.any(tables);
  const Article& chair = room.any(chairs);
  const Index table = room.free_standing(article, 0.9);
  if (!table) return;
  const int pairs = article.width_m > 1.9 ? 3 : article.width_m > 1.3 ? 2 : 1;
  for (int i = 0; i < pairs; ++i) {
    const double aside = (i - 0.5 * (pairs - 1)) * (article.width_m - 0.3) / pairs;
    if (const Index front = room.before(*table, chair, 0.04, aside)) room.set_movable(*front);
    const PlacedItem turned = room.item(*table);
    const double yaw = turned.yaw_deg * std::numbers::pi / 180.0,
                 distance = 0.5 * (article.depth_m + chair.depth_m) + 0.04;
    const Eigen::Vector2d back = Eigen::Rotation2Dd(yaw) * Eigen::Vector2d(aside, distance);
    if (const Index behind = room.at(chair, turned.at + back, turned.yaw_deg)) room.set_movable(*behind);
  }
  room.on(*table, room.any(Stock::kKitchenThings), {0.1, 0.0});
}

void put_some(RoomFurnisher& room, Stock stock, int most, bool near_corner) {
  const int count = room.dice().whole(0, most);
  for (int i = 0; i < count; ++i) room.against_wall(room.any(stock), near_corner);
}

void living(RoomFurnisher& room) {
  if (const Index sofa = room.against_wall(room.any(Stock::kSofas))) {
    if (const Index table = room.before(*sofa, room.any(Stock::kLowTables), 0.4)) add_on_table(room, *table, false);
    if (room.dice().chance(0.5)) room.before(*sofa, room.any(Stock::kArmchairs), 1.5, 0.2);
    room.hang_above(*sofa, "picture", {1.0, 0.7}, 1.5);
    const Article& lamp = room.any(Stock::kStandingLamps);
    if (!room.beside(*sofa, lamp, room.dice().chance(0.5))) room.against_wall(lamp, true);
  }
  if (const Index stand = room.against_wall(room.any(Stock::kTelevisionStands)))
    room.on(*stand, room.any(Stock::kTelevisions), {0.0, 0.0});
  room.against_wall(room.any(Stock::kBookcases));
  if (room.area_m2() > 20.0) add_table(room, Stock::kDiningTables, Stock::kDiningChairs);
  put_some(room, Stock::kArmchairs, 1, true);
  put_some(room, Stock::kPlants, 2, true);
  if (room.dice().chance(0.6)) room.free_standing(room.any(Stock::kRugs), 0.2);
}

void dining(RoomFurnisher& room) {
  add_table(room, Stock::kDiningTables, Stock::kDiningChairs);
  if (const Index board = room.against_wall(room.any(Stock::kSideboards))) add_on_table(room, *board, false);
  put_some(room, Stock::kBookcases, 1, false);
  put_some(room, Stock::kPlants, 2, true);
}

void kitchen(RoomFurnisher& room) {
  if (Index last = room.against_wall(room.any(Stock::kRefrigerators), true)) {
    const bool to_the_right = room.dice().chance(0.5);
    for (std::size_t i = 0; i < 5; ++i) {
      const Article& unit = articles(Stock::kKitchenUnits)[i % articles(Stock::kKitchenUnits).size()];
      Index next = room.beside(*last, unit, to_the_right);
      if (!next && i == 0) next = room.beside(*last, unit, !to_the_right);
      if (!next) break;
      if (unit.class_name == std::string("counter")) room.on(*next, room.any(Stock::kKitchenThings), {0.0, 0.1});
      last = next;
    }
  }
  if (room.area_m2() > 9.0) add_table(room, Stock::kDiningTables, Stock::kDiningChairs);
  put_some(room, Stock::kFloorThings, 1, true);
}

void bedroom(RoomFurnisher& room) {
  if (const Index bed = room.against_wall(room.any(Stock::kDoubleBeds))) {
    for (const bool right : {true, false}) {
      const Index table = room.beside(*bed, room.any(Stock::kBedsideTables), right);
      if (table) room.on(*table, room.any(Stock::kSmallLamps), {0.0, 0.0});
    }
    room.hang_above(*bed, "picture", {0.9, 0.6}, 1.7);
  }
  room.against_wall(room.any(Stock::kWardrobes), true);
  if (room.area_m2() > 11.0) room.against_wall(room.any(Stock::kSideboards));
  put_some(room, Stock::kPlants, 1, true);
  if (room.dice().chance(0.4)) room.free_standing(room.any(Stock::kRugs), 0.2);
}

void children(RoomFurnisher& room) {
  room.against_wall(room.any(Stock::kSingleBeds), true);
  add_desk(room);
  put_some(room, Stock::kBookcases, 2, false);
  put_some(room, Stock::kFloorThings, 2, true);
  if (room.dice().chance(0.5)) room.free_standing(room.any(Stock::kRugs), 0.2);
}

void bath(RoomFurnisher& room) {
  room.against_wall(room.any(Stock::kBaths), true);
  room.against_wall(room.any(Stock::kToilets));
  if (const Index basin = room.against_wall(room.any(Stock::kBasins)))
    room.hang_above(*basin, "mirror", {0.55, 0.7}, 1.5);
  put_some(room, Stock::kWashers, 1, true);
  put_some(room, Stock::kFloorThings, 1, true);
}

void office(RoomFurnisher& room) {
  const int desks = room.area_m2() > 13.0 ? 2 : 1;
  for (int i = 0; i < desks; ++i) add_desk(room);
  room.against_wall(room.any(Stock::kCabinets));
  put_some(room, Stock::kBookcases, 2, false);
  put_some(room, Stock::kPlants, 1, true);
  put_some(room, Stock::kFloorThings, 1, true);
}

void meeting(RoomFurnisher& room) {
  add_table(room, Stock::kMeetingTables, Stock::kMeetingChairs);
  if (const Index stand = room.against_wall(room.any(Stock::kTelevisionStands)))
    room.on(*stand, room.any(Stock::kTelevisions), {0.0, 0.0});
  put_some(room, Stock::kPlants, 2, true);
}

void storage(RoomFurnisher& room) {
  for (int i = 0; i < 5; ++i) room.against_wall(room.any(Stock::kStores), i < 2);
  put_some(room, Stock::kGoods, 2, true);
}

void lounge(RoomFurnisher& room) {
  if (const Index sofa = room.against_wall(room.any(Stock::kSofas)))
    room.before(*sofa, room.any(Stock::kLowTables), 0.4);
  put_some(room, Stock::kArmchairs, 2, true);
  if (const Index unit = room.against_wall(articles(Stock::kKitchenUnits)[0])) {
    room.on(*unit, room.any(Stock::kKitchenThings), {0.0, 0.1});
    room.beside(*unit, articles(Stock::kKitchenUnits)[2], true);
  }
  if (room.area_m2() > 14.0) add_table(room, Stock::kDiningTables, Stock::kDiningChairs);
  put_some(room, Stock::kPlants, 2, true);
}

void ward(RoomFurnisher& room) {
  const int beds = room.area_m2() > 14.0 ? 2 : 1;
  for (int i = 0; i < beds; ++i) {
    const Index bed = room.against_wall(room.any(Stock::kHospitalBeds));
    if (bed) room.beside(*bed, room.any(Stock::kBedsideTables), i == 0);
  }
  room.against_wall(room.any(Stock::kBasins));
  room.against_wall(articles(Stock::kMeetingChairs)[1], true);
}

void examination(RoomFurnisher& room) {
  room.against_wall(room.any(Stock::kHospitalBeds), true);
  add_desk(room);
  room.against_wall(room.any(Stock::kBasins));
  room.against_wall(room.any(Stock::kCabinets), true);
}

void waiting(RoomFurnisher& room) {
  for (int i = 0; i < 3; ++i) {
    const Index bench = room.against_wall(room.any(Stock::kBenches));
    if (bench) room.beside(*bench, room.item(*bench).article, true);
  }
  room.free_standing(room.any(Stock::kLowTables), 1.0);
  put_some(room, Stock::kPlants, 1, true);
}

void corridor(RoomFurnisher& room) {
  const auto things = static_cast<int>(room.area_m2() / 12.0);
  for (int i = 0; i < things; ++i) room.against_wall(room.any(Stock::kCorridorThings));
  put_some(room, Stock::kBenches, static_cast<int>(room.area_m2() / 20.0), false);
}

void hallway(RoomFurnisher& room) {
  put_some(room, Stock::kCorridorThings, 1, false);
  room.against_wall({Stock::kBookcases, "shelving", nullptr, 0.8, 0.3, 1.9});
}

/// One row of racks, from x0 on; the back of a second one leans on it when `is_double`.
void add_racks(RoomFurnisher& room, const Article& rack, double x0, double x1, double y, bool is_double) {
  for (double x = x0 + 0.5 * rack.width_m; x + 0.5 * rack.width_m <= x1; x += rack.width_m + 0.04) {
    room.at(rack, {x, y + 0.5 * rack.depth_m}, 0);
    if (is_double) room.at(rack, {x, y + 1.5 * rack.depth_m + 0.04}, 180);
  }
}

void hall(RoomFurnisher& room) {
  Eigen::AlignedBox2d bounds;
  for (const auto& corner : room.polygon()) bounds.extend(corner);
  const double width = bounds.sizes().x(), depth = bounds.sizes().y(), aisle = room.dice()(2.0, 2.6);
  Article rack = room.any(Stock::kRacks);
  rack.height_m = room.dice()(2.2, 3.2);
  const bool is_double = room.dice().chance(0.5), is_cut = width > 16.0;
  const double thick = is_double ? 2.0 * rack.depth_m + 0.04 : rack.depth_m;
  const double yard = room.dice()(2.6, 4.0);  // left free along one side, where goods stand
  for (double y = 2.2; y + thick < depth - 1.8; y += thick + aisle) {
    const double end = width - yard;
    if (is_cut) {
      const double middle = 0.5 * (1.8 + end);
      add_racks(room, rack, 1.8, middle - 1.1, y, is_double);
      add_racks(room, rack, middle + 1.1, end, y, is_double);
    } else {
      add_racks(room, rack, 1.8, end, y, is_double);
    }
  }
  for (int i = 0; i < static_cast<int>(depth / 2.0); ++i) room.against_wall(room.any(Stock::kGoods));
  for (int i = 0; i < static_cast<int>(depth / 4.0); ++i) room.free_standing(room.any(Stock::kGoods), 0.8);
  if (const Index counter = room.against_wall(room.any(Stock::kCounters))) add_on_table(room, *counter, true);
}

void furnish_for_use(RoomFurnisher& room, RoomUse use) {
  switch (use) {
    case RoomUse::kHallway: return hallway(room);
    case RoomUse::kCorridor: return corridor(room);
    case RoomUse::kLiving: return living(room);
    case RoomUse::kDining: return dining(room);
    case RoomUse::kKitchen: return kitchen(room);
    case RoomUse::kBedroom: return bedroom(room);
    case RoomUse::kChildren: return children(room);
    case RoomUse::kBath: return bath(room);
    case RoomUse::kOffice: return office(room);
    case RoomUse::kMeeting: return meeting(room);
    case RoomUse::kStorage: return storage(room);
    case RoomUse::kLounge: return lounge(room);
    case RoomUse::kWard: return ward(room);
    case RoomUse::kExamination: return examination(room);
    case RoomUse::kWaiting: return waiting(room);
    case RoomUse::kHall: return hall(room);
  }
}

}  // namespace

RoomContents furnish(const PlannedRoom& room, const std::vector<LocalOpening>& openings, double height_m, bool is_plain,
                     Dice dice) {
  RoomFurnisher furnisher(room, openings, height_m, dice);
  furnish_for_use(furnisher, room.use);
  const bool is_path = room.use == RoomUse::kCorridor || room.use == RoomUse::kHall;
  const double spacing = is_plain ? 6.0 : is_path ? 2.4 : 1.3;
  furnisher.hang_pictures(spacing, is_plain ? 0.25 : 0.9);
  return std::move(furnisher).contents();
}

}  // namespace lapis::simulator
