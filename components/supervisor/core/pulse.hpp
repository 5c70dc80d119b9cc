#pragma once

#include <optional>
#include <string>

namespace lapis::supervisor {

enum class Phase { kStarting, kRunning, kEnding };

/// A heartbeat as it is judged.
struct Beat {
  Phase phase = Phase::kStarting;
  std::string activity;
  double silence_s = 0.0;  ///< announced: the next one may take so long
};

/// Whether a process is ready, hangs, or takes too long to end, by its heartbeats. Times are seconds of one clock of
/// the caller's that never steps.
class Pulse {
 public:
  /// Within this after its start a process says something: it announces what takes longer.
  static constexpr double kStart_s = 20.0;

  explicit Pulse(double started_s) : heard_s_(started_s) {}

  void hear(double now_s, const Beat& beat);
  /// The process has been asked to end.
  void ask_to_end(double now_s);
  /// Nobody could listen until now: what was silent before says nothing.
  void forgive(double now_s);

  bool is_ready() const { return newest_ && newest_->phase != Phase::kStarting; }
  /// What the process does, or how far it is; empty: nothing is known.
  std::string activity() const { return newest_ ? newest_->activity : ""; }
  /// Since the last heartbeat, or the start [s].
  double silence_s(double now_s) const { return now_s - heard_s_; }
  /// True when it has been silent for longer than `usual_s` and than what it announced. One that is asked to end has
  /// that time from then on, or from the end of what it announced before, however often it says that it runs.
  bool is_hung(double now_s, double usual_s) const;

 private:
  std::optional<Beat> newest_;
  std::optional<double> asked_s_;
  double heard_s_;
};

}  // namespace lapis::supervisor
