#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lapis::supervisor {

/// A started program with its own session, so that Ctrl-C on the terminal only reaches its parent. It gets SIGTERM when
/// its parent dies, whatever the cause.
class Child {
 public:
  /// Starts the program, whose output is appended to `log`. To be called on the main thread, whose end counts as the
  /// parent's death. Throws std::runtime_error when the log cannot be written; a program that does not exist ends with
  /// status 127.
  Child(const std::filesystem::path& program, const std::vector<std::string>& arguments,
        const std::filesystem::path& log);
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  pid_t pid() const { return pid_; }
  void send(int signal) const;
  /// Kills the program and everything that it has started, without warning, and waits for its end.
  void kill();
  /// Exit status; 128 plus the number of the signal that ended the program; nothing while it runs.
  std::optional<int> status();

 private:
  pid_t pid_ = -1;
  std::optional<int> status_;
};

}  // namespace lapis::supervisor
