#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/geometry/image.hpp"
#include "simulator/core/generator/building_plan.hpp"

namespace lapis::simulator {

/// A box that an item fills, in its room's frame; heights are above the floor.
struct ItemBox {
  Eigen::AlignedBox2d area;
  double bottom_m = 0.0, top_m = 0.0;
};

/// The free space of one room. Items neither overlap each other, nor stand in front of doors, nor in front of windows
/// when they are higher than the sill. A robot can drive from each door to all others, and over at least a quarter of
/// the floor that it reaches in the empty room; no larger part of the floor is cut off.
class RoomSpace {
 public:
  /// @param polygon axis-aligned, counter-clockwise, in the room's frame
  RoomSpace(const Polygon& polygon, const std::vector<LocalOpening>& openings);

  /// Adds the item unless it is in the way.
  bool add(const ItemBox& item);

 private:
  bool meets_anything(const ItemBox& item) const;
  void block(geometry::GrayImage& cells, const Eigen::AlignedBox2d& area) const;
  /// Number of cells that a robot reaches from the first door (without doors: from the first free cell).
  std::size_t reachable(const geometry::GrayImage& blocked, bool& reaches_all_doors) const;

  const Polygon& polygon_;
  Eigen::AlignedBox2d bounds_;
  std::vector<ItemBox> items_;
  std::vector<Eigen::AlignedBox2d> clear_;
  std::vector<ItemBox> before_windows_;  ///< from the sill upwards
  std::vector<Eigen::Vector2i> doors_;   ///< a cell in front of each
  geometry::GrayImage blocked_;          ///< 255 where the robot's centre cannot be
  std::size_t most_cells_ = 0;           ///< reachable while the room is empty
};

}  // namespace lapis::simulator
