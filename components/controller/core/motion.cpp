#include "controller/core/motion.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::controller {
namespace {

/// The value nearest to `wanted` that is within `step` of `last` and within `limit` of 0.
double approached(double last, double wanted, double step, double limit) {
  return std::clamp(std::clamp(wanted, last - step, last + step), -limit, limit);
}

}  // namespace

double stopping_speed(double distance_m, const RobotLimits& limits) {
  if (distance_m <= 0.0) return 0.0;
  // v t + v^2 / (2 a) = d, solved for v.
  const double lost = limits.max_acceleration_m_s2 * limits.reaction_s;
  return std::sqrt(lost * lost + 2.0 * limits.max_acceleration_m_s2 * distance_m) - lost;
}

Velocity ramped(const Velocity& last, const Velocity& wanted, double elapsed_s, const RobotLimits& limits) {
  Velocity next;
  next.forward_m_s =
      approached(last.forward_m_s, wanted.forward_m_s, limits.max_acceleration_m_s2 * elapsed_s, limits.max_speed_m_s);
  const bool is_arc = wanted.forward_m_s != 0.0;
  if (!is_arc) next.forward_m_s = 0.0;
  const double turn = is_arc ? wanted.turn_rad_s * next.forward_m_s / wanted.forward_m_s : wanted.turn_rad_s;
  next.turn_rad_s =
      approached(last.turn_rad_s, turn, limits.max_turn_acceleration_rad_s2 * elapsed_s, limits.max_turn_rate_rad_s);
  return next;
}

}  // namespace lapis::controller
