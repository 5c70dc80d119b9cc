#pragma once

#include <cstddef>
#include <optional>

#include "common/time/time.hpp"

namespace lapis::sensor_replay {

/// What is played, frame by frame, with the topics on which it is published.
class Recording {
 public:
  enum class Step {
    kPublished,
    kSkipped,  ///< the frame cannot be shown; the reason has been counted
    kEnd,
  };

  virtual ~Recording() = default;
  /// Number of frames of the part that is played.
  virtual std::size_t size() const = 0;
  /// Length of that part [s].
  virtual double length_s() const = 0;
  /// True when the depth images have had `number` readers for a while. Call it often.
  virtual bool has_readers(std::size_t number) = 0;
  /// Time stamp of the next frame; nothing at the end.
  virtual std::optional<time::Time> next_stamp() = 0;
  virtual Step publish_next() = 0;
  /// Publishes the newest frame again, for participants of lock-step that have missed it.
  virtual void publish_again() = 0;
  /// Time stamp of the newest frame.
  virtual time::Time stamp() const = 0;
  /// From now on publish_again() does nothing.
  virtual void end() = 0;
};

}  // namespace lapis::sensor_replay
