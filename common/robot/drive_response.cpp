#include "common/robot/drive_response.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::robot {

// A ramp while the limit holds, an exponential after it.
DriveResponse drive_response(double v, double target, double elapsed_s, double lag_s, double limit) {
  const double gap = target - v;
  const double ramp = std::clamp(std::abs(gap) / limit - lag_s, 0.0, elapsed_s);
  const double at_ramp = v + std::copysign(limit * ramp, gap);
  const double rest = elapsed_s - ramp, decay = std::exp(-rest / lag_s);
  return {target + (at_ramp - target) * decay,
          0.5 * (v + at_ramp) * ramp + target * rest + (at_ramp - target) * lag_s * (1.0 - decay)};
}

}  // namespace lapis::robot
