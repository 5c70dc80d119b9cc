#include "tests/support/child_process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace lapis::test {
namespace {

std::filesystem::path new_log_file(const std::string& program) {
  static int number = 0;
  std::string test = "setup";
  if (const auto* info = ::testing::UnitTest::GetInstance()->current_test_info()) {
    test = std::string(info->test_suite_name()) + "." + info->name();
  }
  for (char& c : test) c = c == '/' ? '_' : c;
  const auto folder = bin_dir().parent_path() / "test_logs" / test;
  std::filesystem::create_directories(folder);
  return folder / (std::to_string(++number) + "_" + std::filesystem::path(program).filename().string() + ".log");
}

std::array<int, 2> new_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe for a child process");
  return ends;
}

[[noreturn]] void become(const std::string& path, const std::vector<char*>& argv, int out, int err) {
  // Between fork and exec: only async-signal-safe calls.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  execv(path.c_str(), argv.data());
  constexpr char kMessage[] = "the program could not be executed\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(127);
}

}  // namespace

std::filesystem::path bin_dir() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

ChildProcess::ChildProcess(const std::string& program, const std::vector<std::string>& arguments) {
  const std::string path = program.find('/') == std::string::npos ? (bin_dir() / program).string() : program;
  if (access(path.c_str(), X_OK) != 0) throw std::runtime_error("cannot execute " + path + "; has it been built?");
  log_file_ = new_log_file(program);
  log_stream_ = std::fopen(log_file_.c_str(), "we");
  std::vector<std::string> words = arguments;
  words.insert(words.begin(), path);
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const auto out = new_pipe();
  const auto err = new_pipe();
  pid_ = fork();
  if (pid_ == 0) become(path, argv, out[1], err[1]);
  close(out[1]);
  close(err[1]);
  out_ = out[0];
  err_ = err[0];
  if (pid_ < 0) throw std::runtime_error("fork: " + std::string(std::strerror(errno)));
  drain_ = std::thread([this] { drain(); });
}

ChildProcess::~ChildProcess() {
  if (is_running()) stop(SIGKILL);
  join_drain();
  close(out_);
  close(err_);
  if (log_stream_ != nullptr) std::fclose(log_stream_);
}

void ChildProcess::drain() {
  std::array<pollfd, 2> streams{pollfd{out_, POLLIN, 0}, pollfd{err_, POLLIN, 0}};
  std::array<char, 4096> buffer{};
  int open_streams = 2;
  while (open_streams > 0) {
    if (poll(streams.data(), streams.size(), -1) < 0 && errno != EINTR) break;
    for (std::size_t i = 0; i < streams.size(); ++i) {
      if (streams[i].fd < 0 || streams[i].revents == 0) continue;
      const auto size = read(streams[i].fd, buffer.data(), buffer.size());
      if (size <= 0) {
        streams[i].fd = -1;
        --open_streams;
        continue;
      }
      const std::string text(buffer.data(), static_cast<std::size_t>(size));
      if (log_stream_ != nullptr) {
        std::fwrite(text.data(), 1, text.size(), log_stream_);
        std::fflush(log_stream_);
      }
      const std::lock_guard lock(mutex_);
      if (i == 0) output_ += text;
      all_ += text;
      grew_.notify_all();
    }
  }
  const std::lock_guard lock(mutex_);
  has_ended_ = true;
  grew_.notify_all();
}

void ChildProcess::join_drain() {
  if (drain_.joinable()) drain_.join();
}

bool ChildProcess::wait_for_line(const std::string& text, Seconds deadline) {
  std::unique_lock lock(mutex_);
  const auto is_there = [&] {
    const auto at = all_.find(text);
    return at != std::string::npos && all_.find('\n', at) != std::string::npos;
  };
  grew_.wait_for(lock, deadline, [&] { return has_ended_ || is_there(); });
  return is_there();
}

void ChildProcess::signal(int number) const {
  if (!status_) kill(pid_, number);
}

std::optional<int> ChildProcess::wait(Seconds deadline) {
  if (status_) return status_;
  const int descriptor = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  pollfd end{descriptor, POLLIN, 0};
  const auto patience = std::chrono::duration_cast<std::chrono::milliseconds>(deadline);
  const int ready = poll(&end, 1, static_cast<int>(patience.count()));
  close(descriptor);
  if (ready <= 0) return std::nullopt;
  int status = 0;
  waitpid(pid_, &status, 0);
  status_ = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  join_drain();  // so that output() is complete
  return status_;
}

std::optional<int> ChildProcess::stop(int number, Seconds deadline) {
  signal(number);
  return wait(deadline);
}

bool ChildProcess::is_running() { return pid_ > 0 && !wait(Seconds(0)); }

std::string ChildProcess::output() const {
  const std::lock_guard lock(mutex_);
  return output_;
}

std::string ChildProcess::log() const {
  const std::lock_guard lock(mutex_);
  return all_ + "\n(" + log_file_.string() + ")";
}

bool wait_until_ready(ChildProcess& process, Seconds deadline) { return process.wait_for_line(": ready", deadline); }

long peak_memory_mb(pid_t pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::stol(line.substr(6)) / 1024;
  }
  throw std::runtime_error("no memory is known of process " + std::to_string(pid));
}

}  // namespace lapis::test
