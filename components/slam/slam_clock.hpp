#pragma once

#include <optional>

#include "common/time/stamp_judge.hpp"
#include "common/time/time.hpp"

namespace lapis::slam {

/// The time in which a map lives: that of the camera's clock when the map began, whatever this clock is set to later in
/// free run. Odometry has to have the same clock.
class SlamClock {
 public:
  /// The clock that stamps the camera's frames was set by `step`.
  void set(time::Duration step) {
    shift_ = {shift_.nanoseconds - step.nanoseconds};
    was_set_ = true;
  }

  /// Proceeds to a camera frame with this stamp; returns its time in the map.
  time::Time advance(time::Time stamp, time::Arrival arrival) {
    const bool would_go_back = was_set_ && newest_ && of(stamp) <= newest_->stamp;
    if (would_go_back)
      shift_ = newest_->stamp + kLeastPeriod - stamp;  // the step is known to the jitter of delays only
    was_set_ = false;
    newest_ = time::Stamped{of(stamp), arrival};
    return newest_->stamp;
  }
  /// Time of the newest camera frame in the map; there must have been one.
  time::Time now() const { return newest_->stamp; }

  /// Time in the map of a stamp that is believed.
  time::Time of(time::Time stamp) const { return stamp + shift_; }
  /// Time of a reading of the odometry in the map; nothing when its stamp is not of the camera's time: a stray, or one
  /// of two streams has noticed already that the clock was set.
  std::optional<time::Time> of_odometry(time::Time stamp, time::Arrival arrival) const {
    const time::Stamped reading{of(stamp), arrival};
    if (newest_ && !time::follows(*newest_, reading)) return std::nullopt;
    return reading.stamp;
  }

 private:
  static constexpr time::Duration kLeastPeriod{10'000'000};

  time::Duration shift_;                 // to be added to stamps
  std::optional<time::Stamped> newest_;  // camera frame, in the time of the map
  bool was_set_ = false;                 // since that frame
};

}  // namespace lapis::slam
