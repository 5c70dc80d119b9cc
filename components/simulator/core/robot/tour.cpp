#include "simulator/core/robot/tour.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>
#include <stdexcept>

namespace lapis::simulator {
namespace {

constexpr double kSharp_rad = 0.7;  // the follower turns on the spot for larger angles
constexpr double kStop_s = 1.0;     // time lost by slowing down, stopping, and speeding up
constexpr double kCrawl_m_s = 0.15;
constexpr double kSpeedPerGap = 1.5;  // [1/s]
constexpr double kTourSample_m = 0.05;

std::string place(std::size_t number, const Eigen::Vector2d& p) {
  std::ostringstream text;
  text << "waypoint " << number << " (" << p.x() << ", " << p.y() << ")";
  return text.str();
}

Path plan_leg(const PathPlanner& planner, const NavMap& map, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
              std::size_t number) {
  if (!planner.nearest_free(to)) {
    std::ostringstream problem;
    problem << place(number, to) << " is " << std::max(0.0, map.distance_m(to))
            << " m from an obstacle, too close for the robot; move it";
    throw std::runtime_error(problem.str());
  }
  const auto path = planner.plan(from, to);
  if (!path) {
    throw std::runtime_error(place(number, to) + " cannot be reached from " +
                             (number == 1 ? "the start" : "waypoint " + std::to_string(number - 1)) +
                             "; move it, or make room");
  }
  return *path;
}

/// Angle between the directions of a path from a to b and from b to c.
double bend(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  const Eigen::Vector2d before = b - a, after = c - b;
  return std::abs(std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after)));
}

double drive_time_s(const NavMap& map, const TourConfig& config, const Path& path) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector2d step = path[i] - path[i - 1];
    const int samples = std::max(1, static_cast<int>(step.norm() / kTourSample_m));
    for (int s = 0; s < samples; ++s) {
      const double distance = map.distance_m(path[i - 1] + step * ((s + 0.5) / samples));
      sum += step.norm() / samples / speed_limit_m_s(config, distance);
    }
    const double angle = i + 1 < path.size() ? bend(path[i - 1], path[i], path[i + 1]) : 0.0;
    if (angle > kSharp_rad) sum += angle / config.max_turn_rate_rad_s + kStop_s;
  }
  return sum;
}

/// Angle between the last step of a leg and the first of the next.
double bend(const TourLeg& leg, const TourLeg& next) {
  const auto& a = leg.path;
  const auto& b = next.path;
  return a.size() < 2 || b.size() < 2 ? std::numbers::pi : bend(a[a.size() - 2], a.back(), b[1]);
}

}  // namespace

double speed_limit_m_s(const TourConfig& config, double distance_m) {
  const double gap = std::max(0.0, distance_m - config.path.radius_m);
  return std::min(config.max_speed_m_s, kCrawl_m_s + kSpeedPerGap * gap);
}

Tour plan_tour(const NavMap& map, const Eigen::Vector2d& start, const std::vector<Eigen::Vector2d>& waypoints,
               const TourConfig& config) {
  const PathPlanner planner(map, config.path);
  Tour tour;
  Eigen::Vector2d from = start;
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    Path path = plan_leg(planner, map, from, waypoints[i], i + 1);
    from = path.back();
    tour.length_m += length_m(path);
    tour.duration_s += drive_time_s(map, config, path);
    tour.legs.push_back({std::move(path), true});
  }
  for (std::size_t i = 0; i < tour.legs.size(); ++i) {
    TourLeg& leg = tour.legs[i];
    const bool is_last = i + 1 == tour.legs.size();
    const double angle = is_last ? 0.0 : bend(leg, tour.legs[i + 1]);
    leg.stops = is_last || angle > kSharp_rad;
    if (angle > kSharp_rad) tour.duration_s += angle / config.max_turn_rate_rad_s;
    if (leg.stops) tour.duration_s += kStop_s;
  }
  return tour;
}

}  // namespace lapis::simulator
