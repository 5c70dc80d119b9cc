#include "simulator/scene_yaml.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "common/config/yaml_entry.hpp"
#include "common/mapping/file/label_list_file.hpp"

namespace lapis::simulator {
namespace {

using config::load_yaml;
using config::YamlEntry;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::size_t kMostItems = 10'000, kMostCorners = 200;

Eigen::Vector2d vector2(YamlEntry& entry, const std::string& key) {
  const auto values = entry.numbers(key, 2);
  return {values[0], values[1]};
}

std::vector<Eigen::Vector2d> polygon(YamlEntry& entry, const std::string& key) {
  std::vector<Eigen::Vector2d> corners;
  for (const auto& point : entry.points(key)) corners.emplace_back(point[0], point[1]);
  return corners;
}

SurfaceSpec surface(YamlEntry& room, const std::string& key) {
  SurfaceSpec spec;
  if (!room.has(key)) return spec;
  if (!room.is_map(key)) {
    spec.texture = room.text(key);
    return spec;
  }
  YamlEntry entry = room.entry(key);
  spec.texture = entry.text("texture", "");
  if (entry.has("color")) spec.color = mapping::read_color(entry);
  if (entry.has("variant")) {
    const int variant = entry.whole_number("variant", 0);
    if (variant < 0) entry.refuse("variant must not be negative");
    spec.variant = static_cast<std::uint64_t>(variant);
  }
  entry.done();
  return spec;
}

RoomSpec room(YamlEntry& entry) {
  RoomSpec spec;
  spec.id = entry.text("id");
  spec.type = entry.text("type", spec.id);
  if (entry.has("rect") == entry.has("polygon")) entry.refuse("give either rect or polygon");
  if (entry.has("rect")) {
    const auto r = entry.numbers("rect", 4);
    if (!(r[0] < r[2] && r[1] < r[3])) entry.refuse("rect must be [x0, y0, x1, y1] with x0 < x1 and y0 < y1");
    spec.polygon = {{r[0], r[1]}, {r[2], r[1]}, {r[2], r[3]}, {r[0], r[3]}};
  } else {
    spec.polygon = polygon(entry, "polygon");
    if (spec.polygon.size() < 3 || spec.polygon.size() > kMostCorners)
      entry.refuse("polygon must have from 3 to 200 corners");
  }
  spec.floor = surface(entry, "floor");
  spec.wall = surface(entry, "wall");
  spec.ceiling = surface(entry, "ceiling");
  if (entry.has("height")) spec.height_m = entry.number("height");
  entry.done();
  return spec;
}

OpeningSpec opening(YamlEntry& entry) {
  constexpr std::array<std::pair<const char*, OpeningKind>, 4> kKinds{{{"door", OpeningKind::kDoor},
                                                                       {"passage", OpeningKind::kPassage},
                                                                       {"window", OpeningKind::kWindow},
                                                                       {"leaf", OpeningKind::kLeaf}}};
  OpeningSpec spec;
  int kinds = 0;
  for (const auto& [name, kind] : kKinds) {
    if (!entry.has(name)) continue;
    spec.kind = kind;
    spec.at = vector2(entry, name);
    ++kinds;
  }
  if (kinds != 1) entry.refuse("give one of door, passage, window, leaf: [x, y]");
  const bool is_window = spec.kind == OpeningKind::kWindow;
  spec.width_m = entry.number("width", is_window ? 1.2 : 0.9);
  spec.bottom_m = entry.number("bottom", is_window ? 0.9 : 0.0);
  spec.top_m = entry.number("top", is_window ? 2.1 : 2.05);
  entry.done();
  return spec;
}

/// A place on a wall, as entries of furniture and pictures name it.
class WallPlace {
 public:
  WallPlace(YamlEntry& entry, const std::vector<RoomSpec>& rooms) : entry_(entry), id(entry.text("room")) {
    const auto it = std::find_if(rooms.begin(), rooms.end(), [&](const RoomSpec& r) { return r.id == id; });
    if (it == rooms.end()) entry.refuse("there is no room \"" + id + "\"");
    corners_ = it->polygon;
    edge = entry.is_number("wall") ? numbered_wall() : named_wall(entry.text("wall"));
    along_m = along();
  }

 private:
  YamlEntry& entry_;
  std::vector<Eigen::Vector2d> corners_;

 public:
  const std::string id;
  int edge = 0;
  double along_m = 0.0;

 private:
  Eigen::Vector2d span(std::size_t i) const { return corners_[(i + 1) % corners_.size()] - corners_[i]; }

  int numbered_wall() {
    const int wall = entry_.whole_number("wall", 0);
    if (static_cast<std::size_t>(wall) >= corners_.size()) {
      entry_.refuse("room \"" + id + "\" has no wall " + std::to_string(wall) + "; its last one is " +
                    std::to_string(corners_.size() - 1));
    }
    return wall;
  }

  /// Index of the only wall whose outward normal points, within 44 degrees, to that side (north, east, ...).
  int named_wall(const std::string& side) const {
    constexpr std::array<const char*, 4> kSides{"east", "north", "west", "south"};
    const auto* wanted = std::find(kSides.begin(), kSides.end(), side);
    if (wanted == kSides.end())
      entry_.refuse("wall must be a number, north, east, south, or west, not \"" + side + "\"");
    const double angle = 90.0 * kDegree * static_cast<double>(wanted - kSides.begin());
    const Eigen::Vector2d outward(std::cos(angle), std::sin(angle));
    double twice_area = 0.0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d &a = corners_[i], &b = corners_[(i + 1) % corners_.size()];
      twice_area += a.x() * b.y() - a.y() * b.x();
    }
    std::vector<int> found;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const Eigen::Vector2d direction = span(i).normalized() * (twice_area >= 0.0 ? 1.0 : -1.0);
      if (Eigen::Vector2d(direction.y(), -direction.x()).dot(outward) > std::cos(44.0 * kDegree))
        found.push_back(static_cast<int>(i));
    }
    if (found.size() == 1) return found[0];
    entry_.refuse("room \"" + id + "\" has " + std::to_string(found.size()) + " walls in the " + side +
                  "; give the wall's number");
  }

  double along() {
    if (entry_.has("along") + entry_.has("x") + entry_.has("y") > 1) entry_.refuse("give one of along, x, y");
    const auto wall = static_cast<std::size_t>(edge);
    const double length = span(wall).norm();
    if (entry_.has("along")) {
      const double value = entry_.number("along");
      return value < 0.0 ? length + value : value;
    }
    for (const int axis : {0, 1}) {
      const char* key = axis == 0 ? "x" : "y";
      if (!entry_.has(key)) continue;
      const double slope = span(wall)[axis] / length;
      if (std::abs(slope) < 0.5) entry_.refuse(std::string(key) + " does not change along that wall");
      return (entry_.number(key) - corners_[wall][axis]) / slope;
    }
    return 0.5 * length;
  }
};

/// Number of copies of an entry, and the step between them; the key `row`.
struct Row {
  int count = 1;
  Eigen::Vector2d step{0, 0};  ///< [m]; along a wall only x counts

  /// @param existing number of items that the list has already
  Row(YamlEntry& entry, bool is_on_wall, std::size_t existing) {
    if (existing >= kMostItems) entry.refuse("there are more than 10000 of them");
    if (!entry.has("row")) return;
    YamlEntry row = entry.entry("row");
    count = row.whole_number("count", 1);
    if (count < 1 || count > 1000) row.refuse("count must be from 1 to 1000");
    if (existing + static_cast<std::size_t>(count) > kMostItems) row.refuse("there are more than 10000 with this row");
    step = is_on_wall ? Eigen::Vector2d(row.number("step"), 0.0) : vector2(row, "step");
    row.done();
  }
};

std::variant<AtPoint, AgainstWall, OnItem> place(YamlEntry& entry, const std::vector<RoomSpec>& rooms) {
  if (entry.has("at") + entry.has("room") + entry.has("on") != 1) entry.refuse("give one of at, room, on");
  if (entry.has("at")) return AtPoint{vector2(entry, "at"), entry.number("yaw_deg", 0.0) * kDegree};
  if (entry.has("on")) {
    const Eigen::Vector2d offset = entry.has("offset") ? vector2(entry, "offset") : Eigen::Vector2d(0, 0);
    return OnItem{entry.text("on"), offset, entry.number("yaw_deg", 0.0) * kDegree};
  }
  const WallPlace wall(entry, rooms);
  return AgainstWall{wall.id, wall.edge, wall.along_m, entry.number("gap", 0.02),
                     entry.number("turn_deg", 0.0) * kDegree};
}

void move(std::variant<AtPoint, AgainstWall, OnItem>& place, const Eigen::Vector2d& by) {
  if (auto* point = std::get_if<AtPoint>(&place)) point->at += by;
  if (auto* wall = std::get_if<AgainstWall>(&place)) wall->along_m += by.x();
  if (auto* on = std::get_if<OnItem>(&place)) on->offset += by;
}

void add_furniture(SceneSpec& scene, YamlEntry& entry) {
  FurnitureSpec item;
  item.id = entry.text("id", "");
  item.class_name = entry.text("class");
  item.model = entry.text("model", "");
  if (entry.has("size")) {
    const auto size = entry.numbers("size", 3);
    item.size_m = Eigen::Vector3d(size[0], size[1], size[2]);
  }
  if (entry.has("elevation")) item.elevation_m = entry.number("elevation");
  item.place = place(entry, scene.rooms);
  item.is_movable = entry.flag("movable", false);
  if (entry.has("parts")) {
    for (const auto& [part, class_name] : entry.entry("parts").all_texts()) item.parts[part] = class_name;
  }
  const int variant = entry.whole_number("variant", 0);
  if (variant < 0) entry.refuse("variant must not be negative");
  const bool has_variant = entry.has("variant");
  const Row row(entry, std::holds_alternative<AgainstWall>(item.place), scene.furniture.size());
  entry.done();
  for (int i = 0; i < row.count; ++i) {
    FurnitureSpec& copy = scene.furniture.emplace_back(item);
    if (row.count > 1 && !item.id.empty()) copy.id += "." + std::to_string(i + 1);
    copy.variant = has_variant ? static_cast<std::uint64_t>(variant) : scene.furniture.size();
    move(copy.place, i * row.step);
  }
}

void add_pictures(SceneSpec& scene, YamlEntry& entry) {
  PictureSpec picture;
  picture.class_name = entry.text("class", picture.class_name);
  const WallPlace wall(entry, scene.rooms);
  picture.room = wall.id;
  picture.edge = wall.edge;
  picture.height_m = entry.number("height", picture.height_m);
  if (entry.has("size")) picture.size_m = vector2(entry, "size");
  const int motif = entry.whole_number("motif", 0);
  if (motif < 0) entry.refuse("motif must not be negative");
  const bool has_motif = entry.has("motif");
  const Row row(entry, true, scene.pictures.size());
  entry.done();
  for (int i = 0; i < row.count; ++i) {
    PictureSpec& copy = scene.pictures.emplace_back(picture);
    copy.along_m = wall.along_m + i * row.step.x();
    if (has_motif) copy.motif = static_cast<std::uint64_t>(motif) + static_cast<std::uint64_t>(i);
  }
}

LampSpec lamp(YamlEntry& entry) {
  LampSpec spec;
  spec.at = vector2(entry, "at");
  if (entry.has("height")) spec.height_m = entry.number("height");
  spec.intensity = entry.number("intensity", spec.intensity);
  entry.done();
  return spec;
}

StartPose start(YamlEntry& entry) {
  StartPose pose{vector2(entry, "at"), entry.number("yaw_deg", 0.0) * kDegree};
  entry.done();
  return pose;
}

}  // namespace

SceneSpec read_scene_yaml(const std::filesystem::path& file, const std::filesystem::path& usual_labels) {
  YamlEntry root(file, load_yaml(file), "scene");
  SceneSpec scene;
  scene.name = root.text("name", file.stem().string());
  scene.file = file.string();
  const bool names_labels = root.has("labels");
  const auto labels = file.parent_path() / root.text("labels", "../labels/mpcat40.yaml");
  const bool takes_usual = !names_labels && !usual_labels.empty() && !std::filesystem::exists(labels);
  scene.labels = mapping::read_label_list(takes_usual ? usual_labels : labels);
  scene.height_m = root.number("height", scene.height_m);
  scene.wall_thickness_m = root.number("wall_thickness", scene.wall_thickness_m);
  for (auto& entry : root.entries("rooms", "room")) scene.rooms.push_back(room(entry));
  for (auto& entry : root.entries("openings", "opening")) scene.openings.push_back(opening(entry));
  for (auto& entry : root.entries("furniture", "item")) add_furniture(scene, entry);
  for (auto& entry : root.entries("pictures", "picture")) add_pictures(scene, entry);
  for (auto& entry : root.entries("lamps", "lamp")) scene.lamps.push_back(lamp(entry));
  for (auto& entry : root.entries("starts", "start")) scene.starts.push_back(start(entry));
  if (root.has("tour")) scene.tour = polygon(root, "tour");
  scene.is_stress = root.flag("stress", false);
  root.done();
  return scene;
}

std::vector<Eigen::Vector2d> read_tour_yaml(const std::filesystem::path& file) {
  YamlEntry root(file, load_yaml(file), "tour");
  auto waypoints = polygon(root, "tour");
  root.done();
  return waypoints;
}

}  // namespace lapis::simulator
