#pragma once

#include <chrono>
#include <optional>

#include "common/time/time.hpp"

namespace lapis::time {

/// Tells the messages of a clock that was set from single messages with wrong stamps, for one stream of a source in
/// free run. A stamp fits when it is at most kRestartGap before the newest one, and not further ahead of it than
/// that and the time since that one arrived explain. What follows a stamp that does not fit decides about it.
class StampJudge {
 public:
  using Arrival = std::chrono::steady_clock::time_point;

  enum class Verdict {
    kFits,
    kDoubtful,  ///< to be kept until the next verdict; one that was kept before is a stray
    kStray,     ///< this stamp fits; the message that was kept is a stray
    kStepped    ///< the message that was kept and this one are of a clock that was set
  };

  Verdict judge(Time stamp, Arrival arrival);
  /// How far the clock was set, as it was found last; exact to the jitter of the messages' delay.
  Duration step() const { return step_; }

 private:
  struct Message {
    Time stamp;
    Arrival arrival;
  };
  static bool follows(const Message& before, const Message& now);

  std::optional<Message> newest_;    // that fits
  std::optional<Message> doubtful_;  // that was kept
  Duration step_;
};

}  // namespace lapis::time
