#include "simulator/core/generator/layout.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulator/core/generator/floor_drawing.hpp"

namespace lapis::simulator {
namespace {

constexpr double kGate_m = 3.0;
constexpr std::size_t kEast = 1, kNorth = 2, kWest = 3;  // walls of a hall

/// Draws one building. The corridor of the simple kinds begins at the origin and runs along x.
class Layout {
 public:
  explicit Layout(const BuildingName& name)
      : dice_(Random(name.seed, RandomStream::kBuilding, static_cast<std::uint64_t>(name.kind))), draw_(plan_, dice_) {}

  BuildingPlan flat() && {
    const double c = cm(dice_(1.25, 1.6)), length = cm(dice_(4.9, 7.6)), north = cm(dice_(3.0, 4.1)),
                 south = cm(dice_(3.0, 4.1)), wide = cm(dice_(4.0, 5.6));
    draw_.add_rectangle(RoomUse::kHallway, {0, 0}, {length, c});
    draw_.add_opening(OpeningKind::kLeaf, {0, 0.5 * c}, 0.9);
    std::vector<StripRoom> upper{{RoomUse::kBedroom, dice_(3.0, 3.8)}, {RoomUse::kBath, dice_(1.9, 2.4)}};
    if (length > 7.0) upper.push_back({RoomUse::kChildren, dice_(2.7, 3.3)});
    std::vector<StripRoom> lower{{length > 5.8 ? RoomUse::kChildren : RoomUse::kOffice, dice_(2.4, 3.2)},
                                 {RoomUse::kKitchen, dice_(2.6, 3.4)}};
    const Strip above = side({0, c}, {1, 0}, {0, 1}, length, north),
                below = side({0, 0}, {1, 0}, {0, -1}, length, south);
    draw_.add_strip(above, upper, false);
    const std::size_t kitchen = draw_.add_strip(below, lower, false).back();
    // At the end of the hallway are the living room in the south and another room in the north.
    const double x = cm(length + wall()), top = cm(c + wall());
    const std::size_t living = draw_.add_rectangle(RoomUse::kLiving, {x, -south - wall()}, {cm(x + wide), c});
    const std::size_t dining = draw_.add_rectangle(dice_.chance(0.6) ? RoomUse::kDining : RoomUse::kOffice, {x, top},
                                                   {cm(x + wide), cm(top + north)});
    draw_.add_opening(OpeningKind::kDoor, {length + 0.5 * wall(), 0.5 * c}, 0.9);
    const OpeningKind between = dice_.chance(0.5) ? OpeningKind::kPassage : OpeningKind::kDoor;
    const double at = cm(x + dice_(0.3, 0.7) * wide);
    draw_.add_opening(between, {at, c + 0.5 * wall()}, cm(dice_(0.9, 1.4)));
    if (dice_.chance(0.7)) {  // closes a ring of hallway, living room and kitchen
      const double y = cm(-wall() - dice_(0.35, 0.75) * south);
      if (plan_.rooms[kitchen].polygon[1].x() > 1.5)
        draw_.add_opening(OpeningKind::kDoor, {length + 0.5 * wall(), y}, 0.9);
    }
    for (const std::size_t wall : {std::size_t{0}, std::size_t{1}}) draw_.add_windows(plan_.rooms[living], wall);
    for (const std::size_t wall : {std::size_t{1}, std::size_t{2}}) draw_.add_windows(plan_.rooms[dining], wall);
    return finished(false);
  }

  BuildingPlan straight(bool is_clinic) && {
    const double c = cm(dice_(1.7, 2.3)), length = cm(dice_(13.0, 27.0));
    draw_.add_rectangle(RoomUse::kCorridor, {0, 0}, {length, c});
    draw_.add_opening(OpeningKind::kLeaf, {0, 0.5 * c}, 1.2);
    draw_.add_opening(OpeningKind::kWindow, {length, 0.5 * c}, 1.2);
    const double depth = cm(dice_(3.6, 5.2));
    add_offices(side({0, 0}, {1, 0}, {0, -1}, length, depth), is_clinic);
    if (length > 19.0 && dice_.chance(0.6)) {
      add_branch(length, c, is_clinic);
    } else {
      add_offices(side({0, c}, {1, 0}, {0, 1}, length, cm(dice_(3.4, 5.2))), is_clinic);
    }
    return finished(is_clinic);
  }

  BuildingPlan ring(bool is_clinic) && {
    const double c = cm(dice_(1.7, 2.2)), island = cm(dice_(9.0, 20.0)), deep = 2.0 * cm(dice_(3.1, 4.6));
    const double x = cm(island + 2.0 * (wall() + c)), y = cm(deep + 3.0 * wall() + 2.0 * c);
    const double w = cm(c + wall());  // where the island begins
    add_offices(inner({w, w}, {1, 0}, {0, 1}, island, 0.5 * deep), is_clinic);
    add_offices(inner({w, cm(y - w)}, {1, 0}, {0, -1}, island, 0.5 * deep), is_clinic);
    std::vector<Strip> sides{
        side({0, 0}, {1, 0}, {0, -1}, x, cm(dice_(3.4, 4.6))), side({0, y}, {1, 0}, {0, 1}, x, cm(dice_(3.4, 4.6))),
        side({0, 0}, {0, 1}, {-1, 0}, y, cm(dice_(3.2, 4.2))), side({x, 0}, {0, 1}, {1, 0}, y, cm(dice_(3.2, 4.2)))};
    const int left_out = dice_.whole(0, 3);
    for (int i = 0; i < 4; ++i) {
      const Strip& strip = sides[static_cast<std::size_t>(i)];
      if (i == left_out || (i != (left_out + 1) % 4 && dice_.chance(0.35))) {
        if (dice_.chance(0.6)) add_corridor_windows(strip);
      } else {
        add_offices(strip, is_clinic);
      }
    }
    add_ring_corridor(x, y, c);
    return finished(is_clinic);
  }

  BuildingPlan warehouse() && {
    const double width = cm(dice_(13.0, 26.0)), depth = cm(dice_(10.0, 18.0));
    plan_.height_m = cm(dice_(4.2, 5.8));
    const std::size_t hall = dice_.chance(0.5) ? hall_beside_offices(width, depth) : hall_around_offices(width, depth);
    std::vector<std::size_t> halls{hall};
    if (width < 19.0 && dice_.chance(0.5)) halls.push_back(add_second_hall(width, depth));
    const std::size_t gates = halls.size() == 1 && dice_.chance(0.4) ? kEast : kNorth;
    for (const std::size_t room : halls) {
      add_gates(room, gates);
      for (const std::size_t edge : {kEast, kNorth, kWest}) add_high_windows(room, edge);
    }
    return finished(false);
  }

 private:
  double wall() const { return plan_.wall_m; }

  /// Strip of rooms beyond the wall of a corridor that begins at `begin`.
  Strip side(const Eigen::Vector2d& begin, const Eigen::Vector2d& along, const Eigen::Vector2d& away, double length_m,
             double depth_m) const {
    return {begin + wall() * away, along, away, length_m, depth_m, true};
  }
  Strip inner(const Eigen::Vector2d& begin, const Eigen::Vector2d& along, const Eigen::Vector2d& away, double length_m,
              double depth_m) const {
    return {begin, along, away, length_m, depth_m, false};
  }

  /// Adds the rooms of one strip: a row of equal ones, and others.
  void add_offices(const Strip& strip, bool is_clinic) {
    const double width = strip.length_m < 4.0 ? strip.length_m : dice_(2.7, 3.7);
    const RoomUse usual = !is_clinic ? RoomUse::kOffice : dice_.chance(0.75) ? RoomUse::kWard : RoomUse::kExamination;
    auto rooms = draw_.filled(strip.length_m, width, {usual});
    const std::vector<RoomUse> others =
        is_clinic ? std::vector<RoomUse>{RoomUse::kBath, RoomUse::kWaiting, RoomUse::kStorage, RoomUse::kExamination}
                  : std::vector<RoomUse>{RoomUse::kMeeting, RoomUse::kLounge, RoomUse::kStorage, RoomUse::kBath,
                                         RoomUse::kKitchen};
    const int other = static_cast<int>(std::lround(static_cast<double>(rooms.size()) * (is_clinic ? 0.25 : 0.4)));
    const bool at_the_end = dice_.chance(0.5);
    for (int i = 0; i < other; ++i) {
      StripRoom& room =
          at_the_end ? rooms[rooms.size() - 1 - static_cast<std::size_t>(i)] : rooms[static_cast<std::size_t>(i)];
      room.use = others[static_cast<std::size_t>(dice_.whole(0, static_cast<int>(others.size()) - 1))];
      if (room.use == RoomUse::kMeeting || room.use == RoomUse::kWaiting) room.share_m *= 1.4;
      if (room.use == RoomUse::kBath || room.use == RoomUse::kStorage) room.share_m *= 0.8;
    }
    const auto added = draw_.add_strip(strip, rooms, is_clinic || dice_.chance(0.7));
    for (std::size_t i = 1; i < added.size(); ++i) {
      const bool is_like_others = plan_.rooms[added[i]].copy_of || plan_.rooms[added[i - 1]].copy_of;
      const bool is_original = i + 1 < added.size() && plan_.rooms[added[i + 1]].copy_of;
      if (!is_like_others && !is_original && dice_.chance(0.25)) draw_.join(added[i - 1], added[i], strip);
    }
  }

  /// Adds a second corridor that branches off the first one to the north, with rooms on both sides of it.
  void add_branch(double length_m, double c, bool is_clinic) {
    const double width = cm(dice_(1.7, 2.2)), depth = cm(dice_(3.4, 4.4)), long_m = cm(dice_(8.0, 13.0));
    const double low = cm(dice_(0.4, 0.6) * length_m - 0.5 * width), y = cm(c + wall());
    draw_.add_rectangle(RoomUse::kCorridor, {low, y}, {cm(low + width), cm(y + long_m)});
    draw_.add_opening(OpeningKind::kPassage, {low + 0.5 * width, c + 0.5 * wall()}, cm(width - 0.2));
    plan_.openings.back().top_m = 2.3;
    draw_.add_opening(OpeningKind::kWindow, {low + 0.5 * width, y + long_m}, 1.2);
    add_offices(side({low, y}, {0, 1}, {-1, 0}, long_m, depth), is_clinic);
    add_offices(side({cm(low + width), y}, {0, 1}, {1, 0}, long_m, depth), is_clinic);
    const double left = cm(low - 2.0 * wall() - depth), right = cm(low + width + 2.0 * wall() + depth);
    const double shallow = cm(dice_(3.4, 4.6));
    if (left > 2.4) add_offices(side({0, c}, {1, 0}, {0, 1}, left, shallow), is_clinic);
    if (length_m - right > 2.4) add_offices(side({right, c}, {1, 0}, {0, 1}, cm(length_m - right), shallow), is_clinic);
  }

  /// Adds windows to the outer wall of a corridor, in place of a strip of rooms.
  void add_corridor_windows(const Strip& strip) {
    const double spacing = dice_(3.5, 5.5);
    const int count = std::max(1, static_cast<int>(strip.length_m / spacing));
    for (int i = 0; i < count; ++i) {
      const double along = cm((i + 0.5) / count * strip.length_m);
      draw_.add_opening(OpeningKind::kWindow, strip.begin + along * strip.along - 0.5 * wall() * strip.away, 1.2);
    }
  }

  /// Adds the two halves of a corridor around an island. Passages join them, far from other doors.
  void add_ring_corridor(double x, double y, double c) {
    const double south = gap_in_doors(0.0, c, x), north = gap_in_doors(y - c, y, x), t = 0.5 * wall();
    draw_.add_room(RoomUse::kCorridor, {},
                   {{0, 0},
                    {cm(south - t), 0},
                    {cm(south - t), c},
                    {c, c},
                    {c, cm(y - c)},
                    {cm(north - t), cm(y - c)},
                    {cm(north - t), y},
                    {0, y}});
    RoomFrame east;
    east.origin = {x, y};
    east.axes = -Eigen::Matrix2d::Identity();
    const double s = cm(x - south - t), n = cm(x - north - t);
    draw_.add_room(RoomUse::kCorridor, east,
                   {{0, 0}, {n, 0}, {n, c}, {c, c}, {c, cm(y - c)}, {s, cm(y - c)}, {s, y}, {0, y}});
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(south, 0.5 * c), Eigen::Vector2d(north, y - 0.5 * c)}) {
      draw_.add_opening(OpeningKind::kPassage, at, cm(c - 0.2));
      plan_.openings.back().top_m = 2.3;
    }
  }

  /// The x in the middle part of a corridor along x that is farthest from all openings. @param low, high its walls' y
  double gap_in_doors(double low, double high, double length_m) const {
    double best = 0.5 * length_m, most = -1.0;
    for (double x = 0.3 * length_m; x < 0.7 * length_m; x += 0.1) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const OpeningSpec& opening : plan_.openings) {
        const bool is_beside = opening.at.y() > low - wall() && opening.at.y() < high + wall();
        if (is_beside) nearest = std::min(nearest, std::abs(opening.at.x() - x));
      }
      if (nearest <= most) continue;
      most = nearest;
      best = x;
    }
    return cm(best);
  }

  void add_low_rooms(const Strip& strip) {
    std::vector<StripRoom> rooms{{RoomUse::kOffice, 3.2}, {RoomUse::kLounge, 3.2}};
    if (strip.length_m > 8.5) rooms.push_back({RoomUse::kBath, 2.2});
    if (strip.length_m > 10.5) rooms.push_back({dice_.chance(0.5) ? RoomUse::kStorage : RoomUse::kMeeting, 2.8});
    for (const std::size_t room : draw_.add_strip(strip, rooms, false)) plan_.rooms[room].height_m = 2.6;
  }

  /// Adds a hall with offices outside its southern wall.
  std::size_t hall_beside_offices(double width, double depth) {
    const std::size_t hall = draw_.add_rectangle(RoomUse::kHall, {0, 0}, {width, depth});
    const double length = cm(std::min(width, dice_(7.0, 13.0))), from = cm(dice_(0.0, width - length));
    add_low_rooms(side({from, 0}, {1, 0}, {0, -1}, length, cm(dice_(3.4, 4.4))));
    return hall;
  }

  /// Adds a hall whose south-western corner is filled by offices.
  std::size_t hall_around_offices(double width, double depth) {
    const double length = cm(std::min(width - 4.0, dice_(7.0, 12.0))), x = cm(length + wall()),
                 y = cm(dice_(3.4, 4.2) + wall());
    const std::size_t hall =
        draw_.add_room(RoomUse::kHall, {}, {{x, 0}, {width, 0}, {width, depth}, {0, depth}, {0, y}, {x, y}});
    add_low_rooms(side({0, y}, {1, 0}, {0, -1}, length, cm(y - wall())));
    return hall;
  }

  /// Adds a hall to the east of the first one; one or two wide passages join them.
  std::size_t add_second_hall(double width, double depth) {
    const double x = cm(width + wall()), low = cm(dice_(0.0, 0.5) * depth);
    const std::size_t hall = draw_.add_rectangle(RoomUse::kHall, {x, low}, {cm(x + dice_(7.0, 11.0)), depth});
    const double middle = 0.5 * (low + depth), quarter = 0.25 * (depth - low);
    const std::vector<double> passages =
        depth - low > 9.0 && dice_.chance(0.5) ? std::vector{middle - quarter, middle + quarter} : std::vector{middle};
    for (const double y : passages) {
      draw_.add_opening(OpeningKind::kPassage, {x - 0.5 * wall(), y}, 2.4);
      plan_.openings.back().top_m = 2.8;
    }
    return hall;
  }

  /// Adds one to three loading doors.
  void add_gates(std::size_t room, std::size_t edge) {
    const PlannedRoom& hall = plan_.rooms[room];
    const Eigen::Vector2d a = hall.polygon[edge], b = hall.polygon[(edge + 1) % hall.polygon.size()];
    const int most = std::clamp(static_cast<int>((b - a).norm() / (kGate_m + 1.5)), 1, 3), count = dice_.whole(1, most);
    for (int i = 0; i < count; ++i) {
      draw_.add_opening(OpeningKind::kLeaf, hall.frame.at(a + (i + 0.5) / count * (b - a)), kGate_m);
      plan_.openings.back().top_m = 3.0;
    }
  }

  /// Adds windows high in a wall that has no loading door.
  void add_high_windows(std::size_t room, std::size_t edge) {
    const PlannedRoom& hall = plan_.rooms[room];
    const auto has_gates = [&](const LocalOpening& o) { return o.kind == OpeningKind::kLeaf && o.wall == edge; };
    const auto openings = openings_of(plan_, hall);
    if (std::any_of(openings.begin(), openings.end(), has_gates)) return;
    const std::size_t first = plan_.openings.size();
    draw_.add_windows(hall, edge);
    for (std::size_t i = first; i < plan_.openings.size(); ++i) {
      plan_.openings[i].bottom_m = plan_.height_m - 1.4;
      plan_.openings[i].top_m = plan_.height_m - 0.6;
    }
  }

  BuildingPlan finished(bool is_plain) {
    plan_.is_plain = is_plain;
    std::erase_if(plan_.openings, [&](const OpeningSpec& opening) {
      return opening.kind == OpeningKind::kWindow && !leads_outside(opening);
    });
    for (PlannedRoom& room : plan_.rooms) {
      if (room.copy_of && !has_openings_of(room, plan_.rooms[*room.copy_of])) room.copy_of.reset();
    }
    choose_surfaces();
    turn();
    return std::move(plan_);
  }

  /// True when nothing is built within about a metre in front of a window.
  bool leads_outside(const OpeningSpec& window) const {
    const auto is_in_a_room = [&](const Eigen::Vector2d& p) {
      return std::any_of(plan_.rooms.begin(), plan_.rooms.end(),
                         [&](const PlannedRoom& room) { return contains(room.polygon, room.frame.local(p)); });
    };
    // The window is on the border of its room: along the wall's normal, one side is in the room and the other is not.
    const double half = 0.5 * window.width_m;
    for (const Eigen::Vector2d& normal : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1)}) {
      const Eigen::Vector2d along(normal.y(), normal.x());
      for (const double side : {-1.0, 1.0}) {
        const bool is_inside =
            is_in_a_room(window.at - side * 0.05 * normal) && !is_in_a_room(window.at + side * 0.05 * normal);
        if (!is_inside) continue;
        for (const double distance : {0.3, 0.9}) {
          for (const double aside : {-half, half}) {
            if (is_in_a_room(window.at + side * distance * normal + aside * along)) return false;
          }
        }
      }
    }
    return true;
  }

  bool has_openings_of(const PlannedRoom& room, const PlannedRoom& other) const {
    const auto a = openings_of(plan_, room), b = openings_of(plan_, other);
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const LocalOpening& x, const LocalOpening& y) {
      return x.kind == y.kind && x.wall == y.wall && std::abs(x.along_m - y.along_m) < 0.02 && x.width_m == y.width_m;
    });
  }

  void choose_surfaces() {
    const auto tint = [&](double low, double high) {
      const auto channel = [&] {
        return static_cast<std::uint8_t>(dice_.whole(static_cast<int>(low), static_cast<int>(high)));
      };
      const std::uint8_t r = channel(), g = channel(), b = channel();
      return geometry::Rgb8{r, g, b};
    };
    const std::vector<std::string> walls{"plaster",          "rough_plaster",  "wallpaper_stripes",
                                         "wallpaper_leaves", "wallpaper_dots", "brick"},
        corridors{"plaster", "rough_plaster", "wall_tiles", "brick", "wallpaper_dots"};
    const std::vector<std::string> floors{"planks", "parquet", "carpet", "planks", "tiles"};
    const auto any = [&](const std::vector<std::string>& names) {
      return names[static_cast<std::size_t>(dice_.whole(0, static_cast<int>(names.size()) - 1))];
    };
    for (PlannedRoom& room : plan_.rooms) {
      if (plan_.is_plain) {
        room.wall = {"blank", {244, 244, 242}};
        room.floor = {"blank", {214, 218, 220}};
        room.ceiling = {"blank", {250, 250, 250}};
        continue;
      }
      const bool is_wet = room.use == RoomUse::kBath || room.use == RoomUse::kKitchen;
      room.wall = {is_wet ? "wall_tiles" : any(walls), tint(205, 245)};
      room.floor = {is_wet ? "tiles" : any(floors), tint(170, 240)};
      if (room.use == RoomUse::kCorridor) room.wall.texture = any(corridors);
      if (room.use == RoomUse::kHall) {
        room.wall.texture = dice_.chance(0.5) ? "brick" : "concrete";
        room.floor.texture = room.ceiling.texture = "concrete";
        const auto grey = static_cast<std::uint8_t>(dice_.whole(170, 240));
        room.floor.color = {grey, grey, grey};
        if (room.wall.texture == "concrete") room.wall.color = room.floor.color;
      }
    }
    copy_surfaces();
  }

  /// A copy has the surfaces of its original.
  void copy_surfaces() {
    for (PlannedRoom& room : plan_.rooms) {
      if (!room.copy_of) continue;
      const PlannedRoom& original = plan_.rooms[*room.copy_of];
      room.wall = original.wall;
      room.floor = original.floor;
      room.ceiling = original.ceiling;
      for (SurfaceSpec* surface : {&room.wall, &room.floor, &room.ceiling}) surface->variant = *room.copy_of;
    }
  }

  void turn() {
    const int quarters = dice_.whole(0, 3);
    Eigen::Matrix2d T = Eigen::Matrix2d::Identity();
    if (dice_.chance(0.5)) T(0, 0) = -1.0;
    Eigen::Matrix2d quarter;
    quarter << 0, -1, 1, 0;
    for (int i = 0; i < quarters; ++i) T = quarter * T;
    for (PlannedRoom& room : plan_.rooms) {
      room.frame.origin = T * room.frame.origin;
      room.frame.axes = T * room.frame.axes;
      if (room.frame.is_mirrored() && !is_quadrilateral(room)) make_right_handed(room);
    }
    for (OpeningSpec& opening : plan_.openings) opening.at = T * opening.at;
  }

  static bool is_quadrilateral(const PlannedRoom& room) { return room.polygon.size() == 4; }

  /// Gives a room the building's frame. Rooms with more than four corners have no copies: their frame need not be
  /// mirrored.
  static void make_right_handed(PlannedRoom& room) {
    for (auto& corner : room.polygon) corner = room.frame.at(corner);
    std::reverse(room.polygon.begin(), room.polygon.end());
    room.frame = {};
  }

  BuildingPlan plan_;
  Dice dice_;
  FloorDrawing draw_;
};

}  // namespace

BuildingPlan lay_out(const BuildingName& name) {
  switch (name.kind) {
    case BuildingKind::kFlat: return Layout(name).flat();
    case BuildingKind::kOffice: return Layout(name).straight(false);
    case BuildingKind::kRing: return Layout(name).ring(false);
    case BuildingKind::kWarehouse: return Layout(name).warehouse();
    default: break;
  }
  const bool is_ring = Random(name.seed, RandomStream::kBuilding, 100).uniform(0) < 0.5;
  return is_ring ? Layout(name).ring(true) : Layout(name).straight(true);
}

}  // namespace lapis::simulator
