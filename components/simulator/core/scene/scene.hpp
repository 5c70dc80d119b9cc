#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/model/label_list.hpp"
#include "simulator/core/scene/mesh.hpp"

namespace lapis::simulator {

/// A thing, or a part of the building, that label images distinguish.
struct Instance {
  std::uint16_t id = 0;        ///< as in instance images; 0 never occurs
  std::uint16_t class_id = 0;  ///< 0: unlabelled
  std::string name;
};

/// Floor area of a room; its corners run counter-clockwise.
struct Room {
  std::string id;
  std::string type;
  std::vector<Eigen::Vector2d> polygon;  ///< [m]
  double height_m = 2.6;
};

/// A light that hangs in a room.
struct Lamp {
  Eigen::Vector3f position;
  float intensity = 1.0F;  ///< irradiance at 1 m, relative to white
};

/// Author and licence of a model.
struct Credit {
  std::string model;
  std::string author;
  std::string licence;
  bool operator==(const Credit&) const = default;
};

/// A pose where the robot may begin, in the world frame.
struct StartPose {
  Eigen::Vector2d position;  ///< [m]
  double yaw_rad = 0.0;
};

/// A building as it is rendered. The world frame has z up and is in metres; the floor is at floor_z_m.
struct Scene {
  std::string name;
  Mesh mesh;  ///< Triangle::part is an index into `instances`
  std::vector<Instance> instances;
  mapping::LabelList labels;
  std::vector<Room> rooms;  ///< empty when the source has none
  std::vector<Lamp> lamps;  ///< empty: there is only ambient light
  bool is_lit = true;       ///< false: colours are shown as they are (scans have the light in their textures)
  double floor_z_m = 0.0;
  std::vector<StartPose> starts;      ///< empty: the robot may begin anywhere
  std::vector<Eigen::Vector2d> tour;  ///< waypoints of the bundled tour; empty: none
  bool is_stress = false;             ///< intentionally hard: views without features are intended
  std::vector<Credit> credits;
  std::vector<std::string> warnings;  ///< one line each, such as what replaces something that was not found
};

}  // namespace lapis::simulator
