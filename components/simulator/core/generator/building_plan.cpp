#include "simulator/core/generator/building_plan.hpp"

#include <numeric>

namespace lapis::simulator {
namespace {

/// An opening in the frame of `room`, if one of its walls carries it.
std::optional<LocalOpening> seen_from(const BuildingPlan& plan, const PlannedRoom& room, const OpeningSpec& opening) {
  const Eigen::Vector2d p = room.frame.local(opening.at);
  for (std::size_t i = 0; i < room.polygon.size(); ++i) {
    const Eigen::Vector2d& start = room.polygon[i];
    const Eigen::Vector2d span = room.polygon[(i + 1) % room.polygon.size()] - start;
    const Eigen::Vector2d direction = span.normalized(), inward(-direction.y(), direction.x());
    const double along = (p - start).dot(direction), off = (p - start).dot(inward), half = 0.5 * opening.width_m;
    if (std::abs(off) > 0.75 * plan.wall_m || along < half - 1e-6 || along > span.norm() - half + 1e-6) continue;
    return LocalOpening{opening.kind, i, along, opening.width_m, opening.bottom_m};
  }
  return std::nullopt;
}

}  // namespace

std::vector<LocalOpening> openings_of(const BuildingPlan& plan, const PlannedRoom& room) {
  std::vector<LocalOpening> out;
  for (const OpeningSpec& opening : plan.openings) {
    if (const auto seen = seen_from(plan, room, opening)) out.push_back(*seen);
  }
  return out;
}

std::vector<std::size_t> rooms_at(const BuildingPlan& plan, const OpeningSpec& opening) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < plan.rooms.size(); ++i) {
    if (seen_from(plan, plan.rooms[i], opening)) out.push_back(i);
  }
  return out;
}

double floor_area_m2(const BuildingPlan& plan) {
  return std::accumulate(plan.rooms.begin(), plan.rooms.end(), 0.0,
                         [](double sum, const PlannedRoom& room) { return sum + std::abs(signed_area(room.polygon)); });
}

}  // namespace lapis::simulator
