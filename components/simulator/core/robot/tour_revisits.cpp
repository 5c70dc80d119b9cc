#include "simulator/core/robot/tour_revisits.hpp"

#include <algorithm>
#include <limits>

namespace lapis::simulator {
namespace {

constexpr double kStep_m = 0.5;  // between places that are compared
constexpr double kPass_m = 1.0;  // length of the old path that is driven again

/// Point of a path, by the length along it.
Eigen::Vector2d point_at(const Path& path, double along_m) {
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d step = path[i] - path[i - 1];
    if (along_m <= step.norm()) return path[i - 1] + step.normalized() * along_m;
    along_m -= step.norm();
  }
  return path.back();
}

/// Length along the driven path, up to `latest_m`, of the place to which the drive from `from` is shortest.
double nearest_along_m(const PathPlanner& planner, const Path& driven, double latest_m, const Eigen::Vector2d& from) {
  struct Place {
    double along_m, straight_m;
  };
  std::vector<Place> places;
  for (int i = 0; i * kStep_m <= latest_m; ++i)
    places.push_back({i * kStep_m, (point_at(driven, i * kStep_m) - from).norm()});
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) { return a.straight_m < b.straight_m; });
  double nearest_m = 0.0, least_m = std::numeric_limits<double>::infinity();
  for (const Place& place : places) {
    if (place.straight_m >= least_m) break;  // the drives to all other places are longer, too
    const auto path = planner.plan(from, point_at(driven, place.along_m));
    if (!path || length_m(*path) >= least_m) continue;
    nearest_m = place.along_m;
    least_m = length_m(*path);
  }
  return nearest_m;
}

}  // namespace

std::vector<Eigen::Vector2d> with_revisits(const NavMap& map, const Tour& tour, double spacing_m,
                                           const PathConfig& config) {
  const PathPlanner planner(map, config);
  std::vector<Eigen::Vector2d> waypoints;
  Path driven;
  double next_m = spacing_m;  // length along the driven path at the next revisit
  for (const TourLeg& leg : tour.legs) {
    driven.insert(driven.end(), leg.path.begin(), leg.path.end());
    for (const double end_m = length_m(driven); next_m <= end_m; next_m += spacing_m) {
      const Eigen::Vector2d here = point_at(driven, next_m);
      const double old_m = nearest_along_m(planner, driven, next_m - spacing_m, here);
      waypoints.insert(waypoints.end(), {here, point_at(driven, old_m), point_at(driven, old_m + kPass_m), here});
    }
    waypoints.push_back(leg.path.back());
  }
  return waypoints;
}

}  // namespace lapis::simulator
