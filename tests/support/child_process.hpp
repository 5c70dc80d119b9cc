#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace lapis::test {

using Seconds = std::chrono::duration<double>;

/// Folder of the executables under test: the one of this test.
std::filesystem::path bin_dir();

/// A program started by a test. Everything it prints goes to a log file, named in every failure, and can be waited for.
/// The destructor kills it when it still runs; it also dies with the test.
class ChildProcess {
 public:
  /// `program` is a path or the name of an executable beside the test. Throws std::runtime_error when it cannot start.
  explicit ChildProcess(const std::string& program, const std::vector<std::string>& arguments = {});
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits until a line that contains `text` has been printed; false at the deadline or when the output ended.
  bool wait_for_line(const std::string& text, Seconds deadline = Seconds(10));
  void signal(int number) const;
  /// Waits for the end: exit status, or minus the number of the signal that ended it; nothing at the deadline.
  std::optional<int> wait(Seconds deadline = Seconds(10));
  /// Signal and wait in one.
  std::optional<int> stop(int number, Seconds deadline = Seconds(10));
  bool is_running();

  pid_t pid() const { return pid_; }
  /// Standard output so far.
  std::string output() const;
  /// Both streams so far, and the file that has them.
  std::string log() const;
  const std::filesystem::path& log_file() const { return log_file_; }

 private:
  void drain();
  void join_drain();

  pid_t pid_ = -1;
  int out_ = -1;
  int err_ = -1;
  std::optional<int> status_;
  std::filesystem::path log_file_;
  std::FILE* log_stream_ = nullptr;
  mutable std::mutex mutex_;  // guards what the drain thread collects
  std::condition_variable grew_;
  std::string output_;
  std::string all_;
  bool has_ended_ = false;
  std::thread drain_;
};

/// The line that every component prints when its endpoints exist.
bool wait_until_ready(ChildProcess& process, Seconds deadline = Seconds(10));

/// Most memory that a process has had so far [MB]. Throws std::runtime_error when there is none of that id.
long peak_memory_mb(pid_t pid);

}  // namespace lapis::test
