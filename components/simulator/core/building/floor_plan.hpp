#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

/// A hole in one wall.
struct WallOpening {
  double from_m = 0.0, to_m = 0.0;  ///< along the wall
  double bottom_m = 0.0, top_m = 0.0;
  double depth_m = 0.0;     ///< through the wall, up to its middle where a room lies behind it
  std::size_t opening = 0;  ///< index in SceneSpec::openings
};

/// An edge of a room, seen from the inside.
struct Wall {
  Eigen::Vector2d start, direction, inward;  ///< first corner; unit vectors
  double length_m = 0.0;
  std::vector<WallOpening> openings;  ///< by `from_m`

  Eigen::Vector2d at(double along_m, double off_m) const { return start + along_m * direction + off_m * inward; }
  /// x along the wall, y into the room, z up; origin in the first corner on the floor.
  Eigen::Affine3f T_world_wall() const;
};

struct RoomPlan {
  double height_m = 0.0;
  std::vector<Wall> walls;
};

/// Turns clockwise rooms round (numbers of walls and places on them keep their meaning), fills in ids, textures and
/// motifs that were left out.
/// @throws std::runtime_error naming scene file and item for everything that makes no sense by itself: polygons that
///   cut themselves, rooms, walls, items and classes that do not exist, ids that occur twice, sizes that are not
///   positive
SceneSpec normalised(SceneSpec spec);

/// Walls with their openings, one RoomPlan per room of a normalised spec.
/// @throws std::runtime_error naming scene file and opening when no wall carries it, it leaves its wall, it meets
///   another one, or a door leads outside
std::vector<RoomPlan> plan_walls(const SceneSpec& spec);

/// One line for std::runtime_error: file, item, what is wrong.
[[noreturn]] void refuse(const SceneSpec& spec, const std::string& item, const std::string& what);

/// "picture 3": how messages call a thing without id; numbers begin at 1.
std::string numbered(const std::string& what, std::size_t index);

}  // namespace lapis::simulator
