#pragma once

#include <span>

#include "simulator/core/furniture/workshop.hpp"

namespace lapis::simulator {

/// The usual size of things of a class, and the function that makes their shape.
struct FurnitureClass {
  const char* name;
  double width_m, depth_m, height_m;
  void (*make)(Workshop&);
};

/// Classes of things that people put into a room: seats, tables, beds, storage, small things.
std::span<const FurnitureClass> movable_classes();
/// Classes of things that belong to the building or hang on it: bathroom, kitchen appliances, stairs, curtains,
/// pictures, lamps.
std::span<const FurnitureClass> fixture_classes();

}  // namespace lapis::simulator
