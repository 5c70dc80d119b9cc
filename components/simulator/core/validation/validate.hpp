#pragma once

#include <cstddef>
#include <vector>

#include "common/geometry/image.hpp"
#include "simulator/core/robot/tour.hpp"
#include "simulator/core/validation/feature_check.hpp"
#include "simulator/core/validation/report.hpp"
#include "simulator/core/world.hpp"

namespace lapis::simulator {

struct ValidationConfig {
  TourConfig tour;         ///< with the robot's radius
  FeatureConfig features;  ///< with the robot's camera and radius
};

/// Makes all checks of a scene, in the order in which they are printed. The result is deterministic.
std::vector<Check> validate(const World& world, const ValidationConfig& config, const Progress& progress);

/// True when no check fails.
bool passes(const std::vector<Check>& checks);

/// Picture of the navigation map with the reachable area, rooms, starts (arrows), tour (red), and long loops (blue).
geometry::ColorImage draw_floor_plan(const World& world, const TourConfig& tour);

}  // namespace lapis::simulator
