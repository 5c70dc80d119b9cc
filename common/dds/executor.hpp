#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <vector>

#include "common/dds/subscription.hpp"

namespace lapis::dds {

/// Runs all handlers and timers of a component, one at a time, on the thread that calls spin(); DDS threads only wake
/// it. After each batch of handlers it calls the cycle function, in which the component does its work.
class Executor {
 public:
  using Clock = std::chrono::steady_clock;

  Executor();

  /// The source must outlive the executor's last spin(), and whoever reads sources() later.
  void add(Source& source);
  const std::vector<Source*>& sources() const { return sources_; }
  /// Makes a source read BEST_EFFORT. Not for handlers of samples.
  void become_best_effort(Source& source);
  /// Calls `action` every `period` of wall-clock time, for book-keeping only.
  void every(Clock::duration period, std::function<void()> action);
  /// Calls `action` once, when the steady clock reaches `due`.
  void at(Clock::time_point due, std::function<void()> action);
  void set_cycle(std::function<void()> cycle) { cycle_ = std::move(cycle); }

  /// Samples of one source that are handled before the next source's turn, so that none starves the others.
  static constexpr std::size_t kMostPerTurn = 100;

  /// Handles events until stop().
  void spin();
  /// Gives every source with pending samples a turn, and waits at most `timeout` for the first one; for clients and
  /// tests.
  void spin_once(Clock::duration timeout);
  /// Ends spin(); may be called from any thread.
  void stop();
  /// Makes spin() run a cycle soon; may be called from any thread.
  void wake();

 private:
  struct Timer {
    Clock::duration period;  // zero: once
    Clock::time_point due;
    std::function<void()> action;
  };
  Clock::duration until_next_timer(Clock::duration longest) const;
  bool run_due_timers();
  std::size_t dispatch_all();

  compat::fdds::WaitSet wait_set_;
  compat::fdds::GuardCondition guard_;
  std::vector<Source*> sources_;
  bool has_more_ = false;  // a source may have samples left, of which the wait set says nothing
  std::vector<Timer> timers_;
  std::function<void()> cycle_;
  std::atomic<bool> stopping_{false};
};

}  // namespace lapis::dds
