#include "simulator/core/generator/floor_drawing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace lapis::simulator {
namespace {

constexpr double kDoor_m = 0.9, kDoorMargin_m = 0.25;  // between a door's opening and a corner
constexpr double kLongWall_m = 4.5;                    // walls of this length or more have two windows

const char* name_of(RoomUse use) {
  constexpr std::array<const char*, 16> kNames{"hallway",  "hallway",     "living",  "dining",  "kitchen", "bedroom",
                                               "children", "bath",        "office",  "meeting", "storage", "lounge",
                                               "ward",     "examination", "waiting", "hall"};
  return kNames[static_cast<std::size_t>(use)];
}

}  // namespace

double cm(double length_m) { return std::round(100.0 * length_m) / 100.0; }

std::vector<StripRoom> FloorDrawing::filled(double length_m, double width_m, const std::vector<RoomUse>& uses) const {
  const auto count = std::max(1L, std::lround(length_m / (width_m + plan_.wall_m)));
  std::vector<StripRoom> rooms;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) rooms.push_back({uses[i % uses.size()], width_m});
  return rooms;
}

std::vector<std::size_t> FloorDrawing::add_strip(const Strip& strip, std::vector<StripRoom> rooms, bool makes_copies) {
  double wanted = 0.0;
  for (const StripRoom& room : rooms) wanted += room.share_m;
  const double free = strip.length_m - static_cast<double>(rooms.size() - 1) * plan_.wall_m;
  std::vector<std::size_t> added;
  std::optional<std::size_t> original;
  double from = 0.0, door = 0.0;
  for (std::size_t i = 0; i < rooms.size(); ++i) {
    const bool is_last = i + 1 == rooms.size();
    const double width = is_last ? cm(strip.length_m - from) : cm(free * rooms[i].share_m / wanted);
    if (original && plan_.rooms[*original].use != rooms[i].use) original.reset();
    const bool fits = original && std::abs(plan_.rooms[*original].polygon[1].x() - width) < 0.06;
    const bool is_copy = makes_copies && fits;
    const bool is_mirrored = is_copy && (added.size() - *original + added.front()) % 2 == 1;
    if (!is_copy) door = cm(dice_(0.5 * kDoor_m + kDoorMargin_m, width - 0.5 * kDoor_m - kDoorMargin_m));
    // A copy keeps the width of its original; what rounding leaves over is added to the wall beyond it.
    const double copied = is_copy ? plan_.rooms[*original].polygon[1].x() : width;
    PlannedRoom& room = place(strip, rooms[i].use, from, std::min(copied, width), is_mirrored);
    if (is_copy && copied <= width) room.copy_of = original;
    add_door(room, std::min(door, std::min(copied, width) - 0.5 * kDoor_m - 0.1));
    if (strip.has_windows) add_windows(room, 2);
    added.push_back(plan_.rooms.size() - 1);
    if (!is_copy) original = added.back();
    from = cm(from + width + plan_.wall_m);
  }
  return added;
}

PlannedRoom& FloorDrawing::place(const Strip& strip, RoomUse use, double from_m, double width_m, bool is_mirrored) {
  RoomFrame frame;
  frame.origin = strip.begin + (is_mirrored ? from_m + width_m : from_m) * strip.along;
  frame.axes << (is_mirrored ? -1.0 : 1.0) * strip.along, strip.away;
  const double d = strip.depth_m;
  return plan_.rooms[add_room(use, frame, {{0, 0}, {width_m, 0}, {width_m, d}, {0, d}})];
}

std::size_t FloorDrawing::add_room(RoomUse use, const RoomFrame& frame, Polygon polygon) {
  const std::string base = name_of(use);
  const auto same = std::count_if(plan_.rooms.begin(), plan_.rooms.end(),
                                  [&](const PlannedRoom& room) { return std::string(name_of(room.use)) == base; });
  PlannedRoom room;
  room.id = base + "_" + std::to_string(same + 1);
  room.use = use;
  room.frame = frame;
  room.polygon = std::move(polygon);
  plan_.rooms.push_back(std::move(room));
  return plan_.rooms.size() - 1;
}

std::size_t FloorDrawing::add_rectangle(RoomUse use, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  const Eigen::Vector2d size = high - low;
  RoomFrame frame;
  frame.origin = low;
  return add_room(use, frame, {{0, 0}, {size.x(), 0}, size, {0, size.y()}});
}

void FloorDrawing::add_opening(OpeningKind kind, const Eigen::Vector2d& at, double width_m) {
  OpeningSpec opening;
  opening.kind = kind;
  opening.at = {cm(at.x()), cm(at.y())};
  opening.width_m = width_m;
  if (kind == OpeningKind::kWindow) {
    opening.bottom_m = 0.9;
    opening.top_m = 2.1;
  }
  plan_.openings.push_back(opening);
}

void FloorDrawing::add_door(const PlannedRoom& room, double along_m) {
  add_opening(OpeningKind::kDoor, room.frame.at({along_m, -0.5 * plan_.wall_m}), kDoor_m);
}

void FloorDrawing::add_windows(const PlannedRoom& room, std::size_t wall) {
  const Eigen::Vector2d a = room.polygon[wall], b = room.polygon[(wall + 1) % room.polygon.size()];
  const double length = (b - a).norm();
  if (length < 1.4) return;
  if (length < kLongWall_m) {
    const double width = length < 2.2 ? 0.6 : 1.2;
    add_opening(OpeningKind::kWindow, room.frame.at(0.5 * (a + b)), width);
    return;
  }
  for (const double share : {0.27, 0.73}) add_opening(OpeningKind::kWindow, room.frame.at(a + share * (b - a)), 1.2);
}

void FloorDrawing::join(std::size_t first, std::size_t second, const Strip& strip) {
  const auto end_of = [&](std::size_t room) {
    double most = -1e9;
    for (const auto& corner : plan_.rooms[room].polygon)
      most = std::max(most, (plan_.rooms[room].frame.at(corner) - strip.begin).dot(strip.along));
    return most;
  };
  const double along = std::min(end_of(first), end_of(second)) + 0.5 * plan_.wall_m;
  const double away = cm(dice_(0.45 * strip.depth_m, strip.depth_m - 0.5 * kDoor_m - kDoorMargin_m));
  add_opening(OpeningKind::kDoor, strip.begin + along * strip.along + away * strip.away, kDoor_m);
}

}  // namespace lapis::simulator
