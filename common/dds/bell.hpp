#pragma once

#include <functional>
#include <mutex>
#include <utility>

namespace lapis::dds {

/// Tells somebody that something has changed, from any thread.
class Bell {
 public:
  /// What ring() calls; empty: nothing. Once this has returned, the function before is not called any more.
  void on_ring(std::function<void()> action) {
    const std::lock_guard lock(mutex_);
    action_ = std::move(action);
  }
  void ring() {
    const std::lock_guard lock(mutex_);
    if (action_) action_();
  }

 private:
  std::mutex mutex_;
  std::function<void()> action_;
};

}  // namespace lapis::dds
