#include "simulator/scene_yaml_writer.hpp"

#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <numbers>

namespace lapis::simulator {
namespace {

long degrees(double rad) { return std::lround(rad * 180.0 / std::numbers::pi); }

/// @param values vector of two or three numbers
template <class Vector>
void write_list(YAML::Emitter& out, const Vector& values) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const double value : values) out << value;
  out << YAML::EndSeq;
}

void write_points(YAML::Emitter& out, const std::vector<Eigen::Vector2d>& points) {
  out << YAML::Flow << YAML::BeginSeq;
  for (const auto& point : points) write_list(out, point);
  out << YAML::EndSeq;
}

void write_surface(YAML::Emitter& out, const char* key, const SurfaceSpec& surface) {
  if (surface.texture.empty()) return;
  const std::array<double, 3> color{static_cast<double>(surface.color.r), static_cast<double>(surface.color.g),
                                    static_cast<double>(surface.color.b)};
  out << YAML::Key << key << YAML::Value << YAML::Flow << YAML::BeginMap;
  out << YAML::Key << "texture" << YAML::Value << surface.texture << YAML::Key << "color" << YAML::Value;
  write_list(out, color);
  if (surface.variant) out << YAML::Key << "variant" << YAML::Value << *surface.variant;
  out << YAML::EndMap;
}

void write_room(YAML::Emitter& out, const RoomSpec& room) {
  out << YAML::Key << "id" << YAML::Value << room.id << YAML::Key << "type" << YAML::Value << room.type;
  out << YAML::Key << "polygon" << YAML::Value;
  write_points(out, room.polygon);
  write_surface(out, "floor", room.floor);
  write_surface(out, "wall", room.wall);
  write_surface(out, "ceiling", room.ceiling);
  if (room.height_m) out << YAML::Key << "height" << YAML::Value << *room.height_m;
}

void write_opening(YAML::Emitter& out, const OpeningSpec& opening) {
  constexpr std::array<const char*, 4> kKinds{"door", "passage", "window", "leaf"};  // in the order of OpeningKind
  out << YAML::Key << kKinds[static_cast<std::size_t>(opening.kind)] << YAML::Value;
  write_list(out, opening.at);
  out << YAML::Key << "width" << YAML::Value << opening.width_m << YAML::Key << "bottom" << YAML::Value
      << opening.bottom_m << YAML::Key << "top" << YAML::Value << opening.top_m;
}

void write_place(YAML::Emitter& out, const FurnitureSpec& item) {
  if (const auto* point = std::get_if<AtPoint>(&item.place)) {
    out << YAML::Key << "at" << YAML::Value;
    write_list(out, point->at);
    out << YAML::Key << "yaw_deg" << YAML::Value << degrees(point->yaw_rad);
  } else if (const auto* on = std::get_if<OnItem>(&item.place)) {
    out << YAML::Key << "on" << YAML::Value << on->item << YAML::Key << "offset" << YAML::Value;
    write_list(out, on->offset);
    out << YAML::Key << "yaw_deg" << YAML::Value << degrees(on->yaw_rad);
  } else {
    const auto& wall = std::get<AgainstWall>(item.place);
    out << YAML::Key << "room" << YAML::Value << wall.room << YAML::Key << "wall" << YAML::Value << wall.edge;
    out << YAML::Key << "along" << YAML::Value << wall.along_m << YAML::Key << "gap" << YAML::Value << wall.gap_m;
    out << YAML::Key << "turn_deg" << YAML::Value << degrees(wall.turn_rad);
  }
}

void write_item(YAML::Emitter& out, const FurnitureSpec& item) {
  if (!item.id.empty()) out << YAML::Key << "id" << YAML::Value << item.id;
  out << YAML::Key << "class" << YAML::Value << item.class_name;
  if (!item.model.empty()) out << YAML::Key << "model" << YAML::Value << YAML::DoubleQuoted << item.model;
  if (item.size_m) {
    out << YAML::Key << "size" << YAML::Value;
    write_list(out, *item.size_m);
  }
  if (item.elevation_m) out << YAML::Key << "elevation" << YAML::Value << *item.elevation_m;
  write_place(out, item);
  if (item.is_movable) out << YAML::Key << "movable" << YAML::Value << true;
  if (!item.parts.empty()) out << YAML::Key << "parts" << YAML::Value << YAML::Flow << item.parts;
  out << YAML::Key << "variant" << YAML::Value << item.variant;
}

void write_picture(YAML::Emitter& out, const PictureSpec& picture) {
  out << YAML::Key << "class" << YAML::Value << picture.class_name << YAML::Key << "room" << YAML::Value
      << picture.room;
  out << YAML::Key << "wall" << YAML::Value << picture.edge << YAML::Key << "along" << YAML::Value << picture.along_m;
  out << YAML::Key << "height" << YAML::Value << picture.height_m << YAML::Key << "size" << YAML::Value;
  write_list(out, picture.size_m);
  if (picture.motif) out << YAML::Key << "motif" << YAML::Value << *picture.motif;
}

void write_lamp(YAML::Emitter& out, const LampSpec& lamp) {
  out << YAML::Key << "at" << YAML::Value;
  write_list(out, lamp.at);
  if (lamp.height_m) out << YAML::Key << "height" << YAML::Value << *lamp.height_m;
  out << YAML::Key << "intensity" << YAML::Value << lamp.intensity;
}

void write_start(YAML::Emitter& out, const StartPose& start) {
  out << YAML::Key << "at" << YAML::Value;
  write_list(out, start.position);
  out << YAML::Key << "yaw_deg" << YAML::Value << degrees(start.yaw_rad);
}

/// Writes a list with one map per line.
template <class Item, class Write>
void write_all(YAML::Emitter& out, const char* key, const std::vector<Item>& items, const Write& write) {
  if (items.empty()) return;
  out << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (const Item& item : items) {
    out << YAML::Flow << YAML::BeginMap;
    write(out, item);
    out << YAML::EndMap;
  }
  out << YAML::EndSeq;
}

}  // namespace

std::string to_scene_yaml(const SceneSpec& spec) {
  YAML::Emitter out;
  out.SetDoublePrecision(6);
  out << YAML::BeginMap << YAML::Key << "name" << YAML::Value << spec.name;
  out << YAML::Key << "height" << YAML::Value << spec.height_m;
  out << YAML::Key << "wall_thickness" << YAML::Value << spec.wall_thickness_m;
  if (spec.is_stress) out << YAML::Key << "stress" << YAML::Value << true;
  write_all(out, "rooms", spec.rooms, write_room);
  write_all(out, "openings", spec.openings, write_opening);
  write_all(out, "furniture", spec.furniture, write_item);
  write_all(out, "pictures", spec.pictures, write_picture);
  write_all(out, "lamps", spec.lamps, write_lamp);
  write_all(out, "starts", spec.starts, write_start);
  if (!spec.tour.empty()) {
    out << YAML::Key << "tour" << YAML::Value;
    write_points(out, spec.tour);
  }
  out << YAML::EndMap;
  return std::string(out.c_str()) + '\n';
}

}  // namespace lapis::simulator
