#include "simulator/core/building/keep_clear.hpp"

#include <cmath>

namespace lapis::simulator {
namespace {

constexpr double kDoor_m = 0.7;   // in front of a door: a robot's width, and room to turn
constexpr double kPath_m = 0.35;  // around starts and paths: a robot's radius, and the clearance of planners

/// Rectangle of the points that are, along and across it, no farther than kPath_m from the line.
Polygon strip(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d span = b - a;
  return rectangle(0.5 * (a + b), {span.norm() + 2.0 * kPath_m, 2.0 * kPath_m}, std::atan2(span.y(), span.x()));
}

}  // namespace

std::vector<Polygon> keep_clear(const SceneSpec& spec, const std::vector<RoomPlan>& plan) {
  std::vector<Polygon> zones;
  for (const RoomPlan& room : plan) {
    for (const Wall& wall : room.walls) {
      for (const WallOpening& hole : wall.openings) {
        if (spec.openings[hole.opening].kind == OpeningKind::kWindow) continue;
        zones.push_back({wall.at(hole.from_m, 0.0), wall.at(hole.to_m, 0.0), wall.at(hole.to_m, kDoor_m),
                         wall.at(hole.from_m, kDoor_m)});
      }
    }
  }
  for (const StartPose& start : spec.starts) zones.push_back(strip(start.position, start.position));
  for (std::size_t i = 0; i + 1 < spec.tour.size(); ++i) zones.push_back(strip(spec.tour[i], spec.tour[i + 1]));
  return zones;
}

}  // namespace lapis::simulator
