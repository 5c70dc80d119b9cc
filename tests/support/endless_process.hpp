#pragma once

#include <sys/types.h>

#include <functional>

namespace lapis::test {

/// A copy of this process that does one thing again and again until it is killed; it also dies with this process.
class EndlessProcess {
 public:
  /// Returns when the process has begun. It ends by itself only when `work` returns false.
  explicit EndlessProcess(const std::function<bool()>& work);
  ~EndlessProcess() { kill(); }
  EndlessProcess(const EndlessProcess&) = delete;
  EndlessProcess& operator=(const EndlessProcess&) = delete;
  /// Kills it without warning; false when it had ended by itself.
  bool kill();

 private:
  pid_t pid_ = -1;  // until it has been killed
};

}  // namespace lapis::test
