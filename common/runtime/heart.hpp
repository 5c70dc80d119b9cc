#pragma once

#include <string>

#include "common/dds/publisher.hpp"
#include "common/topics/heartbeat.hpp"

namespace lapis::runtime {

/// Publishes that this process lives, in which phase it is and what it does, so that a supervisor can distinguish one
/// that is busy from one that hangs. On the component's thread, whose silence is what counts.
class Heart {
 public:
  enum class Phase { kStarting, kRunning, kEnding };
  /// Between heartbeats while nothing else is announced [s].
  static constexpr double kPeriod_s = 0.5;

  /// `name`: of the process, with its robot's namespace.
  Heart(dds::Participant& participant, const std::string& name);

  /// Start and end take longer than a cycle: up to kTransition_s are announced with them.
  void enter(Phase phase);
  void beat();
  /// How far the process is; said with the next heartbeat, until something else is said.
  void set_progress(const std::string& text) { message_.activity(text); }

 private:
  friend class LongWork;
  static constexpr double kTransition_s = 20.0;

  lapis_msgs::msg::Heartbeat message_;
  dds::Publisher<lapis_msgs::msg::Heartbeat> publisher_;
};

/// Announces, for as long as it lives, work during which the process is silent. May be nested.
class LongWork {
 public:
  /// `activity`: what is done, for example "saves the map". After `longest_s` the process counts as hung; that is for
  /// the slowest machine and disk, not for the usual one.
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
