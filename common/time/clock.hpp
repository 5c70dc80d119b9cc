#pragma once

#include "common/time/time.hpp"

namespace lapis::time {

/// The current time: that of the system (UTC), or the time last announced on /clock.
class Clock {
 public:
  enum class Kind { kSystem, kSimulated };

  explicit Clock(Kind kind) : kind_(kind) {}

  /// Simulated time is 0 until the first announcement, as in ROS 2.
  Time now() const;
  /// Sets the simulated time; a system clock ignores it.
  void announce(Time t) { simulated_ = t; }
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
  Time simulated_;
};

}  // namespace lapis::time
