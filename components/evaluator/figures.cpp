#include "evaluator/figures.hpp"

#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

namespace lapis::evaluator {

namespace {

constexpr std::chrono::milliseconds kPeriod(20);

std::string figures_script() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "lapis_evaluator_figures.py").string();
}

/// Waits for the end of a child, which is terminated when the process is in a hurry. True when the child exits with
/// status 0.
bool has_succeeded(pid_t child, const std::function<bool()>& is_in_a_hurry) {
  int status = 0;
  pid_t ended = 0;
  for (bool is_asked = false; (ended = waitpid(child, &status, WNOHANG)) == 0;) {
    if (!is_asked && is_in_a_hurry()) is_asked = kill(child, SIGTERM) == 0;
    std::this_thread::sleep_for(kPeriod);
  }
  return ended == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::string figures_command(const std::string& folder) { return "to draw them: " + figures_script() + " " + folder; }

void draw_figures(std::string folder, const std::function<bool()>& is_in_a_hurry) {
  std::string script = figures_script();
  char* arguments[] = {script.data(), folder.data(), nullptr};
  pid_t child = 0;
  sigset_t none;  // our threads block the signals that end a process, but the script must not
  sigemptyset(&none);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const bool has_run = posix_spawn(&child, script.c_str(), nullptr, &attributes, arguments, environ) == 0 &&
                       has_succeeded(child, is_in_a_hurry);
  posix_spawnattr_destroy(&attributes);
  if (!has_run) spdlog::warn("figures were not drawn; {}", figures_command(folder));
}

}  // namespace lapis::evaluator
