#pragma once

#include <optional>

#include "common/time/stamp_judge.hpp"
#include "common/time/time.hpp"

namespace lapis::planner {

/// The time in which a mission lives: that of the clock of slam's frames when their session began, whatever this clock
/// is set to later. So ages and time-outs go on.
class MissionClock {
 public:
  /// Proceeds to a frame with this stamp in free run. A stamp that does not fit its arrival is left out until the next
  /// one decides about it. Returns how far the clock was set since the frame before; nothing when it was not.
  std::optional<time::Duration> advance(time::Time stamp, time::Arrival arrival) {
    const auto verdict = judge_.judge(stamp, arrival);
    if (verdict == time::StampJudge::Verdict::kDoubtful) return std::nullopt;
    stamp_ = stamp;
    if (verdict != time::StampJudge::Verdict::kStepped) return std::nullopt;
    steps_ = {steps_.nanoseconds + judge_.step().nanoseconds};
    return judge_.step();
  }
  /// Proceeds to a frame with this stamp in lock-step, where stamps are believed.
  void believe(time::Time stamp) {
    judge_ = {};
    stamp_ = stamp;
  }

  /// Stamp of the newest frame, by the clock as it is set now.
  time::Time stamp() const { return stamp_; }
  /// Time of that frame in the mission.
  time::Time now() const { return of(stamp_); }
  /// Time in the mission of a stamp of the same clock.
  time::Time of(time::Time stamp) const { return stamp - steps_; }

 private:
  time::StampJudge judge_;
  time::Time stamp_;
  time::Duration steps_;  // sum of the steps by which the clock was set
};

}  // namespace lapis::planner
