#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include "simulator/core/building/floor_plan.hpp"
#include "simulator/core/scene/polygon.hpp"

namespace lapis::simulator {

/// Extents of an item: its size, and how far its lowest point is above what it stands on.
struct ItemExtent {
  Eigen::Vector3d size_m{0, 0, 0};
  double elevation_m = 0.0;
};

/// Where an item is. The origin of its frame is in the middle of the footprint at its lowest point.
struct ItemPose {
  Eigen::Vector2d at{0, 0};
  double yaw_rad = 0.0;
  double bottom_m = 0.0;

  Eigen::Affine3f T_world_item() const;
  Polygon footprint(const ItemExtent& extent) const { return rectangle(at, extent.size_m.head<2>(), yaw_rad); }
};

/// Poses of all furniture of a normalised spec, as the author wrote them down.
/// @param extents one per item
std::vector<ItemPose> place_furniture(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                      const std::vector<ItemExtent>& extents);

/// The same with movable items moved by up to 5 cm and turned by up to 10 degrees, as far as they then stay in their
/// room (those on another item: on it), clear of others and of what keep_clear() keeps free; those that stand in such a
/// place as the author wrote them down stay there. What stands on a moved item goes with it.
std::vector<ItemPose> place_furniture_with_jitter(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                                  const std::vector<ItemExtent>& extents, std::uint64_t seed);

/// Places of all pictures along their walls, as the author wrote them down.
/// @throws std::runtime_error naming file and picture when one leaves its wall, or meets an opening or another picture
std::vector<double> place_pictures(const SceneSpec& spec, const std::vector<RoomPlan>& plan);

/// The same, moved by up to 10 cm along the wall where nothing is in the way.
std::vector<double> place_pictures_with_jitter(const SceneSpec& spec, const std::vector<RoomPlan>& plan,
                                               std::uint64_t seed);

/// Index of a room by its id, in a normalised spec.
std::size_t room_index(const SceneSpec& spec, const std::string& id);

}  // namespace lapis::simulator
