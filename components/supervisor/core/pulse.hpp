#pragma once

#include <optional>
#include <string>

namespace lapis::supervisor {

enum class Phase { kStarting, kRunning, kEnding };

/// The content of a heartbeat that is judged.
struct Beat {
  Phase phase = Phase::kStarting;
  std::string activity;
  double silence_s = 0.0;  ///< announced: the next heartbeat may take this long [s]
};

/// Judges by its heartbeats whether a process is ready, hangs, or takes too long to end. Times are seconds of one
/// monotonic clock of the caller.
class Pulse {
 public:
  /// A process publishes its first heartbeat within this time after its start [s]; it announces work that takes longer.
  static constexpr double kStart_s = 20.0;

  explicit Pulse(double started_s) : heard_s_(started_s) {}

  void hear(double now_s, const Beat& beat);
  /// The process has been asked to end.
  void ask_to_end(double now_s);
  /// The supervisor could not listen until now, so the silence before does not count.
  void forgive(double now_s);

  bool is_ready() const { return newest_ && newest_->phase != Phase::kStarting; }
  /// The activity or the progress of the process; empty when it is not known.
  std::string activity() const { return newest_ ? newest_->activity : ""; }
  /// Time since the last heartbeat, or since the start [s].
  double silence_s(double now_s) const { return now_s - heard_s_; }
  /// True when the process has been silent for longer than `usual_s` and for longer than it announced. A process that
  /// has been asked to end has `usual_s` from then on, or until the end of the silence that it announced, however many
  /// heartbeats it still publishes.
  bool is_hung(double now_s, double usual_s) const;

 private:
  std::optional<Beat> newest_;
  std::optional<double> asked_s_;
  double heard_s_;
};

}  // namespace lapis::supervisor
