#pragma once

#include <optional>

#include "common/time/stamp_judge.hpp"
#include "common/time/time.hpp"

namespace lapis::slam {

/// The time in which a map lives: that of the camera's clock when the map began, whatever its source's clocks are set
/// to later. The camera and the odometry notice that a clock was set one after the other.
class SlamClock {
 public:
  /// The clock that stamps the camera's frames was set by `step`.
  void set_camera(time::Duration step) {
    set(camera_, step);
    was_set_ = true;
  }

  /// Proceeds to a camera frame with this stamp; returns its time in the map.
  time::Time advance(time::Time stamp) {
    const bool would_go_back = was_set_ && now_ && stamp + camera_ <= *now_;
    if (would_go_back) newest_ = camera_ = *now_ + kLeastPeriod - stamp;
    was_set_ = false;
    return *(now_ = stamp + camera_);
  }
  /// Time of the newest camera frame in the map; there must have been one.
  time::Time now() const { return *now_; }

  /// Time of a reading of the odometry in the map; nothing while it is not known whether its clock was set.
  std::optional<time::Time> of_odometry(time::Time stamp, time::StampJudge::Arrival arrival) {
    using Verdict = time::StampJudge::Verdict;
    const Verdict verdict = judge_.judge(stamp, arrival);
    if (verdict == Verdict::kDoubtful) return std::nullopt;
    if (verdict == Verdict::kStepped) set(odometry_, judge_.step());
    return stamp + odometry_;
  }

 private:
  /// A step is found to the jitter of delays only, so streams that were set alike share the shift of the first one.
  void set(time::Duration& shift, time::Duration step) {
    shift = {shift.nanoseconds - step.nanoseconds};
    if (abs(time::Duration{newest_.nanoseconds - shift.nanoseconds}) < kSameStep) shift = newest_;
    newest_ = shift;
  }

  static constexpr time::Duration kSameStep{500'000'000};
  static constexpr time::Duration kLeastPeriod{10'000'000};

  time::StampJudge judge_;                     // of the odometry
  time::Duration camera_, odometry_, newest_;  // to be added to stamps; newest_: one of the other two
  std::optional<time::Time> now_;
  bool was_set_ = false;  // since the newest frame of the camera
};

}  // namespace lapis::slam
