#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "simulator/core/building/floor_plan.hpp"
#include "simulator/core/looks/textures.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {
namespace {

// These bound the number of cells of 0.2 m.
constexpr double kMaxReach_m = 1000.0, kMaxLength_m = 100.0, kMaxArea_m2 = 2000.0;
constexpr double kMinSize_m = 0.001, kMaxSize_m = 50.0;  // of furniture

/// Checks a spec, and fills in values that were left out, list by list.
class Normaliser {
 public:
  explicit Normaliser(SceneSpec& spec) : spec_(spec) {}

  void run() {
    check_building();
    for (RoomSpec& room : spec_.rooms) normalise(room);
    turn_clockwise_rooms();
    for (std::size_t i = 0; i < spec_.openings.size(); ++i) check(spec_.openings[i], numbered("opening", i));
    std::set<std::string> ids;
    for (std::size_t i = 0; i < spec_.furniture.size(); ++i) normalise(spec_.furniture[i], i, ids);
    normalise_pictures();
    for (std::size_t i = 0; i < spec_.lamps.size(); ++i) check(spec_.lamps[i], numbered("lamp", i));
    for (std::size_t i = 0; i < spec_.starts.size(); ++i) check_inside(spec_.starts[i].position, numbered("start", i));
    for (std::size_t i = 0; i < spec_.tour.size(); ++i) check_inside(spec_.tour[i], numbered("tour point", i));
  }

 private:
  void check_building() {
    for (const char* name : {"wall", "floor", "ceiling", "door", "window", "lighting"}) check_class(name, "labels");
    if (spec_.rooms.empty()) refuse(spec_, "rooms", "there are none");
    if (!(spec_.wall_thickness_m >= 0.02 && spec_.wall_thickness_m <= 1.0))
      refuse(spec_, "wall_thickness", "must be from 0.02 to 1");
    std::set<std::string> ids;
    for (const RoomSpec& room : spec_.rooms) {
      if (room.id.empty()) refuse(spec_, "rooms", "a room has no id");
      if (!ids.insert(room.id).second) refuse(spec_, called(room), "the id occurs twice");
    }
  }

  static std::string called(const RoomSpec& room) { return "room \"" + room.id + "\""; }

  void normalise(RoomSpec& room) {
    check_extent(room);
    if (!is_simple(room.polygon)) refuse(spec_, called(room), "its outline touches or cuts itself");
    const double height = room.height_m.value_or(spec_.height_m);
    if (!(height >= 1.5 && height <= 20.0)) refuse(spec_, called(room), "height must be from 1.5 to 20");
    if (room.floor.texture.empty()) room.floor.texture = "planks";
    if (room.wall.texture.empty()) room.wall.texture = "plaster";
    if (room.ceiling.texture.empty()) room.ceiling.texture = "plaster";
    for (const SurfaceSpec* surface : {&room.floor, &room.wall, &room.ceiling}) {
      if (!is_texture(surface->texture)) {
        refuse(spec_, called(room), "no texture is called \"" + surface->texture + "\"");
      }
    }
  }

  void check_extent(const RoomSpec& room) const {
    const auto is_far = [&](const Eigen::Vector2d& corner) {
      return !(corner.cwiseAbs().maxCoeff() <= kMaxReach_m) ||
             (corner - room.polygon.front()).cwiseAbs().maxCoeff() > kMaxLength_m;
    };
    if (std::any_of(room.polygon.begin(), room.polygon.end(), is_far) ||
        std::abs(signed_area(room.polygon)) > kMaxArea_m2) {
      refuse(spec_, called(room), "must have at most 100 m and 2000 m2, within 1 km of the origin");
    }
  }

  /// Reverses the corners, and converts the numbers of walls and the places on them.
  void turn_clockwise_rooms() {
    std::set<std::string> turned;
    for (const RoomSpec& room : spec_.rooms) {
      if (signed_area(room.polygon) < 0.0) turned.insert(room.id);
    }
    const auto turn_place = [&](const std::string& id, int& edge, double& along_m, const std::string& item) {
      if (!turned.contains(id)) return;
      const RoomSpec& room = room_with_edge(id, edge, item);
      const auto n = static_cast<int>(room.polygon.size());
      along_m = wall_length(room, edge) - along_m;
      edge = (2 * n - 2 - edge) % n;
    };
    for (std::size_t i = 0; i < spec_.furniture.size(); ++i) {
      if (auto* place = std::get_if<AgainstWall>(&spec_.furniture[i].place))
        turn_place(place->room, place->edge, place->along_m, called(spec_.furniture[i], i));
    }
    for (std::size_t i = 0; i < spec_.pictures.size(); ++i) {
      PictureSpec& picture = spec_.pictures[i];
      turn_place(picture.room, picture.edge, picture.along_m, numbered("picture", i));
    }
    for (RoomSpec& room : spec_.rooms) {
      if (turned.contains(room.id)) std::reverse(room.polygon.begin(), room.polygon.end());
    }
  }

  void check(const OpeningSpec& opening, const std::string& item) const {
    if (!(opening.width_m > 0.1)) refuse(spec_, item, "width must be more than 0.1");
    if (!(opening.bottom_m >= 0.0 && opening.top_m > opening.bottom_m + 0.1))
      refuse(spec_, item, "top must lie above bottom, and bottom not below the floor");
    if (opening.kind != OpeningKind::kWindow && opening.bottom_m > 0.0)
      refuse(spec_, item, "only windows may have a bottom above the floor");
  }

  void check(const LampSpec& lamp, const std::string& item) const {
    const RoomSpec& room = check_inside(lamp.at, item);
    if (lamp.height_m) check_range("height", *lamp.height_m, {0.1, room.height_m.value_or(spec_.height_m)}, item);
    check_range("intensity", lamp.intensity, {0.0, 1000.0}, item);
  }

  static std::string called(const FurnitureSpec& item, std::size_t index) {
    return item.id.empty() ? numbered("furniture", index) + " (" + item.class_name + ")" : "item \"" + item.id + "\"";
  }

  void normalise(FurnitureSpec& item, std::size_t index, std::set<std::string>& ids) {
    const std::string name = called(item, index);
    check_class(item.class_name, name);
    for (const auto& [part, class_name] : item.parts) check_class(class_name, name);
    if (item.size_m) check_each("size", *item.size_m, {kMinSize_m, kMaxSize_m}, name);
    if (item.elevation_m) check_range("elevation", *item.elevation_m, {-kMaxSize_m, kMaxSize_m}, name);
    if (const auto* place = std::get_if<AtPoint>(&item.place)) {
      check_each("at", place->at, {-kMaxReach_m, kMaxReach_m}, name);
    }
    if (const auto* place = std::get_if<AgainstWall>(&item.place)) {
      check_along(room_with_edge(place->room, place->edge, name), place->edge, place->along_m, name);
      check_range("gap", place->gap_m, {-1.0, kMaxLength_m}, name);
    }
    if (const auto* place = std::get_if<OnItem>(&item.place)) {
      check_each("offset", place->offset, {-kMaxSize_m, kMaxSize_m}, name);
      if (!ids.contains(place->item))
        refuse(spec_, name, "no item \"" + place->item + "\" comes before it to stand on");
    }
    if (item.id.empty()) item.id = item.class_name + "#" + std::to_string(index + 1);
    if (!ids.insert(item.id).second) refuse(spec_, name, "the id occurs twice");
  }

  void normalise_pictures() {
    std::set<std::uint64_t> motifs;
    for (const PictureSpec& picture : spec_.pictures) {
      if (picture.motif) motifs.insert(*picture.motif);
    }
    std::uint64_t next = 0;
    for (std::size_t i = 0; i < spec_.pictures.size(); ++i) {
      PictureSpec& picture = spec_.pictures[i];
      const std::string name = numbered("picture", i);
      check_class(picture.class_name, name);
      check_along(room_with_edge(picture.room, picture.edge, name), picture.edge, picture.along_m, name);
      check_each("size", picture.size_m, {0.1, kMaxSize_m}, name);
      while (!picture.motif && motifs.contains(next)) ++next;
      if (!picture.motif) picture.motif = next++;
    }
  }

  void check_class(const std::string& class_name, const std::string& item) const {
    if (!spec_.labels.id_of(class_name)) refuse(spec_, item, "the labels have no class \"" + class_name + "\"");
  }

  struct Range {
    double low, high;
  };

  void check_range(const char* key, double value, const Range& range, const std::string& item) const {
    if (value >= range.low && value <= range.high) return;  // false for NaN, which is refused
    std::ostringstream problem;
    problem << key << " must be from " << range.low << " to " << range.high;
    refuse(spec_, item, problem.str());
  }

  template <class Vector>
  void check_each(const char* key, const Vector& values, const Range& range, const std::string& item) const {
    for (const double value : values) check_range(key, value, range, item);
  }

  /// The room that contains the point.
  const RoomSpec& check_inside(const Eigen::Vector2d& at, const std::string& item) const {
    const auto room = std::find_if(spec_.rooms.begin(), spec_.rooms.end(),
                                   [&](const RoomSpec& candidate) { return contains(candidate.polygon, at); });
    if (room == spec_.rooms.end()) refuse(spec_, item, "lies in no room");
    return *room;
  }

  const RoomSpec& room_with_edge(const std::string& id, int edge, const std::string& item) const {
    const auto it = std::find_if(spec_.rooms.begin(), spec_.rooms.end(), [&](const RoomSpec& r) { return r.id == id; });
    if (it == spec_.rooms.end()) refuse(spec_, item, "there is no room \"" + id + "\"");
    if (edge < 0 || static_cast<std::size_t>(edge) >= it->polygon.size())
      refuse(spec_, item, "room \"" + id + "\" has no wall " + std::to_string(edge));
    return *it;
  }

  static double wall_length(const RoomSpec& room, int edge) {
    const auto i = static_cast<std::size_t>(edge);
    return (room.polygon[(i + 1) % room.polygon.size()] - room.polygon[i]).norm();
  }

  void check_along(const RoomSpec& room, int edge, double along_m, const std::string& item) const {
    if (!(along_m >= 0.0 && along_m <= wall_length(room, edge)))
      refuse(spec_, item, "wall " + std::to_string(edge) + " of room \"" + room.id + "\" ends before that place");
  }

  SceneSpec& spec_;
};

}  // namespace

SceneSpec normalised(SceneSpec spec) {
  Normaliser(spec).run();
  return spec;
}

}  // namespace lapis::simulator
