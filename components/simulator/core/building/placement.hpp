#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/core/building/floor_plan.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {

/// Size of an item (width, depth, height), and height of its lowest point above the surface on which it is placed.
struct ItemExtent {
  Eigen::Vector3d size_m{0, 0, 0};
  double elevation_m = 0.0;
};

/// Pose of an item in the scene. The origin of its frame is in the middle of the footprint at its lowest point.
struct ItemPose {
  Eigen::Vector2d at{0, 0};
  double yaw_rad = 0.0;
  double bottom_m = 0.0;

  Eigen::Affine3f T_world_item() const;
  Polygon footprint(const ItemExtent& extent) const { return rectangle(at, extent.size_m.head<2>(), yaw_rad); }
};

/// Poses of all furniture of a normalised spec, as its author wrote them.
/// @param extents one per item
std::vector<ItemPose> place_furniture(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                      const std::vector<ItemExtent>& extents);

/// The same, but movable items are moved by up to 5 cm and turned by up to 10 degrees. A moved item stays in its room
/// (one on another item: on that), and clear of other items and of the areas of keep_clear(); where no such move is
/// found, the item stays where its author put it. Items that stand on a moved item move with it.
std::vector<ItemPose> place_furniture_with_jitter(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                                  const std::vector<ItemExtent>& extents, std::uint64_t seed);

/// Places of all pictures along their walls [m], as the author wrote them.
/// @throws std::runtime_error naming file and picture when one leaves its wall, or overlaps an opening or another
///   picture
std::vector<double> place_pictures(const SceneSpec& spec, const std::vector<RoomPlan>& plan);

/// The same, but pictures are moved by up to 10 cm along the wall where nothing is in the way.
std::vector<double> place_pictures_with_jitter(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                               std::uint64_t seed);

/// Index of a room by its id, in a normalised spec.
std::size_t room_index(const SceneSpec& spec, const std::string& id);

}  // namespace lapis::simulator
