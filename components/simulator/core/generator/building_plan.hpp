#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/core/scene/polygon.hpp"
#include "simulator/core/scene/scene_spec.hpp"

namespace lapis::simulator {

/// Use of a generated room, which decides how it is furnished.
enum class RoomUse {
  kHallway,
  kCorridor,
  kLiving,
  kDining,
  kKitchen,
  kBedroom,
  kChildren,
  kBath,
  kOffice,
  kMeeting,
  kStorage,
  kLounge,
  kWard,
  kExamination,
  kWaiting,
  kHall
};

/// Frame of a room in the building: rotated by a multiple of 90 degrees, perhaps mirrored.
struct RoomFrame {
  Eigen::Vector2d origin{0, 0};
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();  ///< columns: the room's x and y axes in the building

  Eigen::Vector2d at(const Eigen::Vector2d& local) const { return origin + axes * local; }
  Eigen::Vector2d local(const Eigen::Vector2d& at) const { return axes.transpose() * (at - origin); }
  bool is_mirrored() const { return axes.determinant() < 0.0; }
  /// Yaw in the building of an item that has this yaw in the room [rad]; its front looks along -y at yaw 0.
  double yaw_rad(double local_rad) const {
    const Eigen::Vector2d front = axes * Eigen::Vector2d(std::sin(local_rad), -std::cos(local_rad));
    return std::atan2(front.x(), -front.y());
  }
};

/// A door or window in one wall of a room.
struct LocalOpening {
  OpeningKind kind = OpeningKind::kDoor;
  std::size_t wall = 0;  ///< goes from corner `wall` of the polygon to the next
  double along_m = 0.0;  ///< of the middle, from the wall's first corner
  double width_m = 0.9, bottom_m = 0.0;
};

struct PlannedRoom {
  std::string id;
  RoomUse use = RoomUse::kOffice;
  RoomFrame frame;
  Polygon polygon;  ///< in the room's frame, counter-clockwise [m]
  SurfaceSpec floor, wall, ceiling;
  std::optional<double> height_m;
  std::optional<std::size_t> copy_of;  ///< index of an earlier room with the same furniture (in its own frame)
};

/// A building without furniture. All lengths are whole centimetres.
struct BuildingPlan {
  double height_m = 2.6, wall_m = 0.12;
  std::vector<PlannedRoom> rooms;
  std::vector<OpeningSpec> openings;
  bool is_plain = false;  ///< without textures and with few pictures
};

/// Doors and windows in the walls of one room.
std::vector<LocalOpening> openings_of(const BuildingPlan& plan, const PlannedRoom& room);

/// Indices of the rooms in whose walls an opening is; a door has two.
std::vector<std::size_t> rooms_at(const BuildingPlan& plan, const OpeningSpec& opening);

/// Floor area of all rooms. [m2]
double floor_area_m2(const BuildingPlan& plan);

}  // namespace lapis::simulator
