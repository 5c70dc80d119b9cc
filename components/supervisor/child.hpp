#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lapis::supervisor {

/// A program that was started, in a session of its own: Ctrl-C on the terminal is its parent's alone. It is asked to
/// end when its parent dies, however that happens.
class Child {
 public:
  /// What it prints goes to the end of `log`. To be called on the main thread, whose end counts as the parent's death.
  /// Throws std::runtime_error when the log cannot be written; a program that is not there ends with status 127.
  Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
        const std::filesystem::path& log);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const { return pid_; }
  void send(int signal) const;
  /// Ends it and whatever it has started, without warning, and waits for that.
  void kill();
  /// Exit status, 128 and the number of the signal that ended it, or nothing while it runs.
  std::optional<int> status();

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace lapis::supervisor
