#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace lapis::command_line {

/// Notes SIGINT and SIGTERM, which then do not end the process. Make it before other threads start: they must not
/// receive the signals.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool has_come() const { return has_come_; }
  /// Calls `wake` from another thread when a signal comes. Only once, before a signal is waited for.
  void watch(std::function<void()> wake);

 private:
  std::atomic<bool> has_come_{false};
  std::thread thread_;
};

}  // namespace lapis::command_line
