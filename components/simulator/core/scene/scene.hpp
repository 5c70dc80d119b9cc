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

/// Where a model comes from and under which licence.
struct Credit {
  std::string model;
  std::string author;
  std::string licence;
  bool operator==(const Credit&) const = default;
};

/// Where the robot may begin.
struct StartPose {
  Eigen::Vector2d position;  ///< [m]
  double yaw_rad = 0.0;
};

/// A building as it is rendered. World frame: z up, metres; the floor is at floor_z_m.
struct Scene {
  std::string name;
  Mesh mesh;  ///< Triangle::part indexes `instances`
  std::vector<Instance> instances;
  mapping::LabelList labels;
  std::vector<Room> rooms;  ///< empty when the source knows none
  std::vector<Lamp> lamps;  ///< empty: evenly lit (scanned assets carry their light in their textures)
  bool is_lit = true;       ///< false: colours are shown as they are
  double floor_z_m = 0.0;
  std::vector<StartPose> starts;      ///< empty: anywhere
  std::vector<Eigen::Vector2d> tour;  ///< waypoints of the bundled tour; empty: none
  bool is_stress = false;             ///< made to be hard: views without features are on purpose
  std::vector<Credit> credits;
  std::vector<std::string> warnings;  ///< what stands in for something that was not found, one line each
};

}  // namespace lapis::simulator
