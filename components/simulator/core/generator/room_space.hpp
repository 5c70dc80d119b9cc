#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "common/geometry/image.hpp"
#include "simulator/core/generator/building_plan.hpp"

namespace lapis::simulator {

/// A box that an item fills, in its room's frame.
struct ItemBox {
  Eigen::AlignedBox2d area;
  double bottom_m = 0.0, top_m = 0.0;
};

/// What is free in one room: items neither meet each other, nor stand before doors, nor before windows when they are
/// high, and a robot can drive from each door to all others and over a good part of the floor that it had without them,
/// and nothing is fenced off.
class RoomSpace {
 public:
  /// @param polygon axis-aligned, counter-clockwise, in the room's frame
  RoomSpace(const Polygon& polygon, const std::vector<LocalOpening>& openings);

  /// Adds the item unless it is in the way.
  bool add(const ItemBox& item);

 private:
  bool meets_anything(const ItemBox& item) const;
  void block(geometry::GrayImage& cells, const Eigen::AlignedBox2d& area) const;
  /// Cells that a robot reaches from the first door (without doors: from the first free cell).
  std::size_t reachable(const geometry::GrayImage& blocked, bool& reaches_all_doors) const;

  const Polygon& polygon_;
  Eigen::AlignedBox2d bounds_;
  std::vector<ItemBox> items_;
  std::vector<Eigen::AlignedBox2d> clear_;
  std::vector<ItemBox> before_windows_;  ///< from the sill upwards
  std::vector<Eigen::Vector2i> doors_;   ///< a cell before each
  geometry::GrayImage blocked_;          ///< 255 where the robot's middle cannot be
  std::size_t most_cells_ = 0;           ///< reachable while the room is empty
};

}  // namespace lapis::simulator
