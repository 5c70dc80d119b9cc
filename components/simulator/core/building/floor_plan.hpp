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
  double depth_m = 0.0;     ///< half the gap to the room behind the wall or, without one, the wall's thickness
  std::size_t opening = 0;  ///< index in SceneSpec::openings
};

/// An edge of a room, seen from the inside.
struct Wall {
  Eigen::Vector2d start, direction, inward;  ///< first corner [m]; unit vectors along the wall and into the room
  double length_m = 0.0;
  std::vector<WallOpening> openings;  ///< sorted by `from_m`

  Eigen::Vector2d at(double along_m, double off_m) const { return start + along_m * direction + off_m * inward; }
  /// The wall's frame: x along the wall, y into the room, z up; origin in the first corner on the floor.
  Eigen::Affine3f T_world_wall() const;
};

struct RoomPlan {
  double height_m = 0.0;
  std::vector<Wall> walls;
};

/// Makes clockwise rooms counter-clockwise (numbers of walls and places on them are converted, so that they keep their
/// meaning), and fills in ids, textures and motifs that were left out.
/// @throws std::runtime_error naming scene file and item for everything that makes no sense by itself: polygons that
///   intersect themselves, rooms, walls, items and classes that do not exist, ids that occur twice, sizes that are not
///   positive
SceneSpec normalised(SceneSpec spec);

/// Walls with their openings, one RoomPlan per room of a normalised spec.
/// @throws std::runtime_error naming scene file and opening when no wall carries it, when it does not fit into its wall
///   or overlaps another one, or when a door or passage leads outside
std::vector<RoomPlan> plan_walls(const SceneSpec& spec);

/// Throws std::runtime_error with one line: file, item, and what is wrong.
[[noreturn]] void refuse(const SceneSpec& spec, const std::string& item, const std::string& what);

/// Name of a thing without id in messages, such as "picture 3"; numbers begin at 1.
std::string numbered(const std::string& what, std::size_t index);

}  // namespace lapis::simulator
