#pragma once

#include "common/time/time.hpp"

namespace lapis::time {

/// Says the time: the system's (UTC), or the one that /clock last announced.
class Clock {
 public:
  enum class Kind { kSystem, kSimulated };

  explicit Clock(Kind kind) : kind_(kind) {}

  /// Simulated time is 0 until the first announcement, as in ROS 2.
  Time now() const;
  /// Takes over an announcement of simulated time; a system clock ignores it.
  void announce(Time t) { simulated_ = t; }
  Kind kind() const { return kind_; }

 private:
  Kind kind_;
  Time simulated_;
};

}  // namespace lapis::time
