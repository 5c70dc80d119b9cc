#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>

#include "common/time/time.hpp"

namespace lapis::controller {

struct WatchdogConfig {
  // In [0.05, 60]. At 20 Hz, 0.22 s gives a command of 0 within 0.3 s.
  double pose_timeout_s = 0.22;
  double camera_timeout_s = 0.22;
  double map_timeout_s = 0.22;
  double planner_timeout_s = 0.22;
};

/// Inputs without which the robot must not move: depth images, its pose, a depth image that could be used together with
/// a pose, the mapper's obstacles, and a planner.
enum class Input : std::size_t { kCamera, kPose, kView, kMap, kPlanner };
inline constexpr std::initializer_list<Input> kAllInputs{Input::kCamera, Input::kPose, Input::kView, Input::kMap,
                                                         Input::kPlanner};

/// Monitors the age of every input. The caller gives times of arrival on any one clock. Stamps are those of the data
/// and are compared with the camera's newest stamp, so that an input that lags behind is old even when it has just
/// arrived. Both comparisons use absolute differences: after a clock has jumped, every input is old until it arrives
/// again.
class Watchdog {
 public:
  explicit Watchdog(const WatchdogConfig& config);

  /// Notes an arrival. A repeated stamp does not count as new, because the source or its clock has stopped.
  void note(Input input, time::Time arrival, std::optional<time::Time> stamp = std::nullopt);
  /// The first of these inputs that is too old; nothing when all are fresh.
  std::optional<Input> stale(time::Time now, std::initializer_list<Input> needed = kAllInputs) const;
  /// Text such as "no pose for more than 0.22 s".
  std::string describe(Input input) const;

 private:
  struct Watched {
    const char* name;
    time::Duration timeout;
    std::optional<time::Time> arrival;
    std::optional<time::Time> stamp;
  };
  bool is_stale(const Watched& watched, time::Time now) const;

  std::array<Watched, 5> inputs_;
};

}  // namespace lapis::controller
