#include "simulator/core/generator/furnish.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>

#include "simulator/core/generator/furnish_hall.hpp"

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

/// Adds a desk at a wall, with a chair in front of it.
void add_desk(RoomFurnisher& room) {
  const Index desk = room.against_wall(room.any(Stock::kDesks));
  if (!desk) return;
  add_on_table(room, *desk, true);
  if (const Index chair = room.before(*desk, room.any(Stock::kDeskChairs), 0.06)) room.set_movable(*chair);
  room.hang_above(*desk, room.dice().chance(0.4) ? "board_panel" : "picture", {0.9, 0.6}, 1.6);
}

/// Adds a table with chairs along its long sides, nearer to a wall where there is little space. False when it does not
/// fit.
bool add_table(RoomFurnisher& room, Stock tables, Stock chairs) {
  const Article& article = room.any(tables);
  const Article& chair = room.any(chairs);
  Index table = room.free_standing(article, 0.9);
  if (!table) table = room.free_standing(article, 0.5);
  if (!table) return false;
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
  return true;
}

/// Adds the first article of its kind that fits.
Index put_one(RoomFurnisher& room, Stock stock) {
  for (const Article& article : articles(stock)) {
    if (const Index added = room.against_wall(article, true)) return added;
  }
  return std::nullopt;
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
      if (!next) next = room.against_wall(unit);
      if (!next) break;
      if (unit.class_name == std::string("counter")) room.on(*next, room.any(Stock::kKitchenThings), {0.0, 0.1});
      last = next;
    }
  }
  if (room.area_m2() > 9.0) add_table(room, Stock::kDiningTables, Stock::kDiningChairs);
  put_some(room, Stock::kFloorThings, 1, true);
}

void bedroom(RoomFurnisher& room) {
  Index bed = room.against_wall(room.any(Stock::kDoubleBeds), room.area_m2() < 13.0);
  if (!bed) bed = put_one(room, Stock::kDoubleBeds);
  if (!bed) bed = put_one(room, Stock::kSingleBeds);
  if (bed) {
    for (const bool right : {true, false}) {
      const Index table = room.beside(*bed, room.any(Stock::kBedsideTables), right);
      if (table) room.on(*table, room.any(Stock::kSmallLamps), {0.0, 0.0});
    }
    room.hang_above(*bed, "picture", {0.9, 0.6}, 1.7);
  }
  if (!room.against_wall(room.any(Stock::kWardrobes), true) && !put_one(room, Stock::kWardrobes))
    put_one(room, Stock::kSideboards);
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
  if (!add_table(room, Stock::kMeetingTables, Stock::kMeetingChairs))
    add_table(room, Stock::kDiningTables, Stock::kMeetingChairs);
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
    const Index bed = room.against_wall(room.any(Stock::kHospitalBeds), room.area_m2() < 18.0);
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
    case RoomUse::kHall: return furnish_hall(room);
  }
}

bool is_home(RoomUse use) {
  constexpr std::array kRooms{RoomUse::kHallway, RoomUse::kLiving,   RoomUse::kDining,
                              RoomUse::kBedroom, RoomUse::kChildren, RoomUse::kLounge};
  return std::find(kRooms.begin(), kRooms.end(), use) != kRooms.end();
}

/// Share of the bare stretches of wall that gets large pictures, so that a camera near the wall finds features on it.
double covered_share(const PlannedRoom& room) {
  const bool has_pattern = room.wall.texture == "brick" || room.wall.texture == "wall_tiles";
  if (room.use == RoomUse::kHall) return has_pattern ? 0.4 : 0.75;
  return has_pattern ? 0.4 : is_home(room.use) ? 1.0 : 0.9;
}

}  // namespace

RoomContents furnish(const PlannedRoom& room, const std::vector<LocalOpening>& openings, double height_m,
                     const FurnishOptions& options, Dice dice) {
  RoomFurnisher furnisher(room, openings, height_m, dice);
  furnish_for_use(furnisher, room.use);
  if (options.has_panes) {
    for (const Article& pane : articles(Stock::kPanes)) furnisher.free_standing(pane, 0.5);
  }
  const bool is_wide = options.is_plain || room.use == RoomUse::kHall;
  const double spacing = is_wide ? 6.0 : room.use == RoomUse::kCorridor ? 2.4 : 1.3;
  if (!options.is_plain) furnisher.hang_low(is_home(room.use) ? "picture" : "board_panel", covered_share(room));
  furnisher.hang_pictures(spacing, options.is_plain ? 0.25 : 0.9);
  return std::move(furnisher).contents();
}

}  // namespace lapis::simulator
