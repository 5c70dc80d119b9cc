#pragma once

#include <sys/types.h>

#include <functional>

namespace lapis::test {

/// A copy of this process that does one thing again and again until it is killed.
class EndlessProcess {
 public:
  /// Returns when the process has begun. It ends by itself only when `work` returns false.
  explicit EndlessProcess(const std::function<bool()>& work);
  /// Kills it without warning; false when it had ended by itself.
  bool kill() const;

 private:
  pid_t pid_ = -1;
};

}  // namespace lapis::test
