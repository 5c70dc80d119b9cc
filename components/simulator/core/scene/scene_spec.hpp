#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "common/geometry/image.hpp"
#include "common/mapping/model/label_list.hpp"
#include "simulator/core/scene/scene.hpp"

namespace lapis::simulator {

/// A procedural texture and its tint.
struct SurfaceSpec {
  std::string texture;  ///< empty: the default of its use; see looks/textures.hpp for the names
  geometry::Rgb8 color{255, 255, 255};
  std::optional<std::uint64_t> variant{};  ///< equal variants look alike; default: the room's number
};

/// Walls stand on the edges of the polygon, which are their inside faces; neighbouring rooms leave the wall's thickness
/// between them. Wall `i` runs from corner `i` to the next one.
struct RoomSpec {
  std::string id;
  std::string type;
  std::vector<Eigen::Vector2d> polygon;  ///< in either direction [m]
  SurfaceSpec floor, wall, ceiling;      ///< defaults: planks, plaster, plaster
  std::optional<double> height_m;        ///< default SceneSpec::height_m
};

enum class OpeningKind {
  kDoor,     ///< a passage with a frame (class door)
  kPassage,  ///< a passage without a frame
  kWindow,   ///< closed by a bright pane (class window)
  kLeaf      ///< a closed door, which is part of the outer wall (class door)
};

/// A hole in the wall nearest to `at` (within half a metre) and in the one behind it, if there is one. Doors and
/// passages need both.
struct OpeningSpec {
  OpeningKind kind = OpeningKind::kDoor;
  Eigen::Vector2d at{0, 0};  ///< middle, on or between the walls [m]
  double width_m = 0.9;
  double bottom_m = 0.0;
  double top_m = 2.05;
};

/// A free place on the floor (or at an elevation).
struct AtPoint {
  Eigen::Vector2d at{0, 0};
  double yaw_rad = 0.0;  ///< 0: the front looks along -y
};
/// A place with the item's back to a wall, and its front to the room.
struct AgainstWall {
  std::string room;
  int edge = 0;           ///< number of the wall
  double along_m = 0.0;   ///< of the item's middle, from the wall's first corner
  double gap_m = 0.02;    ///< between back and wall
  double turn_rad = 0.0;  ///< added to the heading
};
/// A place on top of another item, which comes earlier in the list; `offset` is in that item's frame (x along its
/// width, y along its depth, the front is at -y).
struct OnItem {
  std::string item;
  Eigen::Vector2d offset{0, 0};
  double yaw_rad = 0.0;  ///< relative to that item
};

struct FurnitureSpec {
  std::string id;                         ///< for OnItem and messages; generated when empty
  std::string class_name;                 ///< of the scene's labels
  std::string model;                      ///< catalogue id ("Scopia#sofa") or empty: parametric furniture of the class
  std::optional<Eigen::Vector3d> size_m;  ///< width, depth, height; default: the catalogue's or the class's
  std::optional<double> elevation_m;  ///< of its lowest point above what it stands on; default: the catalogue's or 0
  std::variant<AtPoint, AgainstWall, OnItem> place;
  bool is_movable = false;                   ///< jitter moves it a little
  std::map<std::string, std::string> parts;  ///< material or group name -> class, where it differs
  std::uint64_t variant = 0;                 ///< of parametric furniture: colours, books, ...
};

/// A picture, mirror, screen, or board, flat on a wall.
struct PictureSpec {
  std::string class_name = "picture";
  std::string room;
  int edge = 0;
  double along_m = 0.0;
  double height_m = 1.5;               ///< of its middle
  Eigen::Vector2d size_m{0.6, 0.45};   ///< width, height
  std::optional<std::uint64_t> motif;  ///< default: a free number; pictures that share one look alike, and never move
};

struct LampSpec {
  Eigen::Vector2d at{0, 0};
  std::optional<double> height_m;  ///< default: 0.35 m below the ceiling
  double intensity = 1.0;
};

/// A building, as config/scenes/<name>.yaml describes it.
struct SceneSpec {
  std::string name;
  std::string file;  ///< name that messages show
  mapping::LabelList labels;
  double height_m = 2.6;
  double wall_thickness_m = 0.12;
  std::vector<RoomSpec> rooms;
  std::vector<OpeningSpec> openings;
  std::vector<FurnitureSpec> furniture;
  std::vector<PictureSpec> pictures;
  std::vector<LampSpec> lamps;  ///< empty: one per 12 m2 of every room
  std::vector<StartPose> starts;
  std::vector<Eigen::Vector2d> tour;
  bool is_stress = false;  ///< intentionally hard: views without features are intended
};

}  // namespace lapis::simulator
