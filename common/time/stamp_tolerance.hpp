#pragma once

#include <deque>
#include <optional>

#include "common/time/time.hpp"

namespace lapis::time {

/// How far the stamps of messages that belong to one frame may differ, from the stream that leads: 0.6 of the time
/// between its messages, which is half of a period and a tenth for its jitter, at most kLargest. A camera of any rate
/// whose depth comes anywhere between two colour images is joined, and no neighbour's depth.
class StampTolerance {
 public:
  static constexpr Duration kLargest{120'000'000};  // 0.6 of the period at 5 Hz

  /// `fixed`: the tolerance; zero: it follows from the stream.
  explicit StampTolerance(Duration fixed) : fixed_(fixed) {}

  /// For the oldest message that waits; `next`: the stamp behind it, if there is one. Nothing: not known until then.
  std::optional<Duration> of(Time oldest, std::optional<Time> next) const;
  /// The leading stream's message of this stamp has been processed.
  void note(Time stamp);
  /// The stamps of the stream have jumped; a step back is noticed by itself.
  void begin_anew();

 private:
  Duration fixed_;
  std::deque<Duration> periods_;  // between the newest messages
  std::optional<Time> newest_;
};

}  // namespace lapis::time
