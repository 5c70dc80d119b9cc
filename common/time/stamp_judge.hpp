#pragma once

#include <chrono>
#include <optional>

#include "common/time/time.hpp"

namespace lapis::time {

/// When a process handled a message first, not when the message was received. Handlers only store their messages, so
/// the two are close together, except after the process was busy: what came meanwhile is handled at one moment.
using Arrival = std::chrono::steady_clock::time_point;

/// A message of a stream: its stamp, and when it was handled.
struct Stamped {
  Time stamp;
  Arrival arrival;
};

/// Whether a message can follow another one of the same clock in free run: its stamp is at most kRestartGap before the
/// other's, and not further ahead of it than that and the time between their arrivals explain.
bool follows(const Stamped& before, const Stamped& now);

/// Tells the messages of a clock that was set from single messages with wrong stamps, for one stream of a source in
/// free run. What comes after a message that does not follow the one before decides about it. Arrivals are times of
/// handling: after the process was busy, its pause counts for the first message, and nothing for those that follow.
class StampJudge {
 public:
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
  std::optional<Stamped> newest_;    // that fits
  std::optional<Stamped> doubtful_;  // that was kept
  Duration step_;
};

}  // namespace lapis::time
