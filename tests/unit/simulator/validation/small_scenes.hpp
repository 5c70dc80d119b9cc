#pragma once

#include <string>

#include "simulator/core/building/build_scene.hpp"
#include "simulator/core/validation/report.hpp"

namespace lapis::simulator::test {

inline mapping::LabelList small_labels() {
  return mapping::LabelList::from_names({{1, "wall"},
                                         {2, "floor"},
                                         {3, "ceiling"},
                                         {4, "door"},
                                         {5, "window"},
                                         {6, "lighting"},
                                         {7, "table"},
                                         {8, "cabinet"},
                                         {9, "picture"},
                                         {10, "cushion"},
                                         {11, "chair"},
                                         {12, "objects"}});
}

inline RoomSpec rectangular_room(const std::string& id, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  RoomSpec room;
  room.id = id;
  room.type = id;
  room.polygon = {low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  return room;
}

/// A room of 4 m x 3 m and a hallway of 2 m x 3 m east of it, with a door between them.
inline SceneSpec two_rooms() {
  SceneSpec spec;
  spec.name = "small";
  spec.file = "small.yaml";
  spec.labels = small_labels();
  spec.rooms = {rectangular_room("living", {0, 0}, {4, 3}), rectangular_room("hallway", {4.12, 0}, {6.12, 3})};
  OpeningSpec door;
  door.at = {4.06, 1.5};
  spec.openings = {door};
  spec.starts = {{{2.0, 1.5}, 0.0}};
  spec.tour = {{5.1, 1.5}, {2.0, 1.5}};
  return spec;
}

/// The new item, at the floor of the living room.
inline FurnitureSpec& add_item(SceneSpec& spec, const std::string& id, const std::string& class_name,
                               const Eigen::Vector3d& size_m, const Eigen::Vector2d& at, double elevation_m = 0.0) {
  FurnitureSpec item;
  item.id = id;
  item.class_name = class_name;
  item.size_m = size_m;
  item.elevation_m = elevation_m;
  item.place = AtPoint{at, 0.0};
  return spec.furniture.emplace_back(item);
}

/// On top of an item.
inline FurnitureSpec& put_on(SceneSpec& spec, const std::string& id, const std::string& class_name,
                             const Eigen::Vector3d& size_m, const std::string& below, double elevation_m = 0.0) {
  FurnitureSpec& item = add_item(spec, id, class_name, size_m, {0, 0}, elevation_m);
  item.place = OnItem{below};
  return item;
}

inline void add_picture(SceneSpec& spec, int wall, double along_m) {
  PictureSpec picture;
  picture.room = "living";
  picture.edge = wall;
  picture.along_m = along_m;
  spec.pictures.push_back(picture);
}

/// Two rooms, furnished as they should be.
inline SceneSpec good_spec() {
  SceneSpec spec = two_rooms();
  add_item(spec, "desk", "table", {1.2, 0.6, 0.74}, {1.0, 2.65});
  put_on(spec, "box", "objects", {0.3, 0.2, 0.25}, "desk");
  add_item(spec, "chair", "chair", {0.45, 0.45, 0.9}, {1.0, 2.0});
  add_item(spec, "cupboard", "cabinet", {0.8, 0.4, 1.8}, {0.6, 0.25});
  add_picture(spec, 0, 2.5);
  add_picture(spec, 2, 0.8);
  return spec;
}

inline Scene build(const SceneSpec& spec) {
  BuildOptions options;
  options.with_jitter = false;
  return build_scene(spec, {}, options);
}

/// All that a check has to say, for messages of tests.
inline std::string text_of(const Check& check) {
  std::string text = check.name + ": " + check.figures;
  for (const auto& line : check.details) text += "\n  " + line;
  return text;
}

}  // namespace lapis::simulator::test
