#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>

#include "common/time/time.hpp"

namespace lapis::controller {

struct WatchdogConfig {
  // In [0.05, 60]; with a period of 20 Hz after 0.22 s, a command of 0 within 0.3 s.
  double pose_timeout_s = 0.22;
  double camera_timeout_s = 0.22;
  double map_timeout_s = 0.22;
  double planner_timeout_s = 0.22;
};

/// What the robot must not move without: depth images, its pose, a depth image that could be used together with a pose,
/// the mapper's obstacles, and a planner.
enum class Input : std::size_t { kCamera, kPose, kView, kMap, kPlanner };
inline constexpr std::initializer_list<Input> kAllInputs{Input::kCamera, Input::kPose, Input::kView, Input::kMap,
                                                         Input::kPlanner};

/// Knows how old every input is. Times of arrival are given by the caller on any one clock; stamps are those of the
/// data, and are compared with the camera's newest: so an input that lags behind is old, too, however late it came.
/// Both are compared in both directions: after a clock has jumped everything is old until it comes anew.
class Watchdog {
 public:
  explicit Watchdog(const WatchdogConfig& config);

  /// Something new arrived. The same stamp again is nothing new: its source, or its clock, has stopped.
  void note(Input input, time::Time arrival, std::optional<time::Time> stamp = std::nullopt);
  /// The first of these inputs that is too old; nothing when all are fresh.
  std::optional<Input> stale(time::Time now, std::initializer_list<Input> needed = kAllInputs) const;
  /// "no pose for more than 0.22 s"
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
