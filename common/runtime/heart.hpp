#pragma once

#include <string>

#include "common/dds/publisher.hpp"
#include "common/topics/heartbeat.hpp"

namespace lapis::runtime {

/// Publishes heartbeats with the phase and the activity of this process, so that a supervisor can distinguish a busy
/// process from one that hangs. Heartbeats come from the component's thread, because it is the thread that must not
/// hang.
class Heart {
 public:
  enum class Phase { kStarting, kRunning, kEnding };
  /// Time between heartbeats while no longer silence is announced [s].
  static constexpr double kPeriod_s = 0.5;

  /// `name`: name of the process, with the robot's namespace.
  Heart(dds::Participant& participant, const std::string& name);

  /// Enters a phase. Start and end take longer than a cycle, so a silence of up to kTransition_s is announced for them.
  void enter(Phase phase);
  void beat();
  /// Sets the progress that the next heartbeats report as the activity.
  void set_progress(const std::string& text) { message_.activity(text); }

 private:
  friend class LongWork;
  static constexpr double kTransition_s = 20.0;

  lapis_msgs::msg::Heartbeat message_;
  dds::Publisher<lapis_msgs::msg::Heartbeat> publisher_;
};

/// Announces, during its lifetime, work during which the process is silent. May be nested.
class LongWork {
 public:
  /// `activity`: the work, for example "saves the map". After `longest_s` seconds the process counts as hung, so choose
  /// it for the slowest machine and disk, not for the usual one.
  LongWork(Heart& heart, const std::string& activity, double longest_s);
  ~LongWork();
  LongWork(const LongWork&) = delete;
  LongWork& operator=(const LongWork&) = delete;

 private:
  Heart& heart_;
  std::string activity_before_;
  double silence_before_s_;
};

}  // namespace lapis::runtime
