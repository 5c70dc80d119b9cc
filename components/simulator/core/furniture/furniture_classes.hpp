#pragma once

#include <span>

#include "simulator/core/furniture/workshop.hpp"

namespace lapis::simulator {

/// How things of a class are made, and their usual size.
struct FurnitureClass {
  const char* name;
  double width_m, depth_m, height_m;
  void (*make)(Workshop&);
};

/// What people put into a room: seats, tables, beds, storage, small things.
std::span<const FurnitureClass> movable_classes();
/// What belongs to the building or hangs on it: bathroom, kitchen appliances, stairs, curtains, pictures, lamps.
std::span<const FurnitureClass> fixture_classes();

}  // namespace lapis::simulator
