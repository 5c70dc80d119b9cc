#include "evaluator/figures.hpp"

#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>

namespace lapis::evaluator {

namespace {

std::string figures_script() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "lapis_evaluator_figures.py").string();
}

}  // namespace

std::string figures_command(const std::string& folder) { return "to draw them: " + figures_script() + " " + folder; }

void draw_figures(std::string folder) {
  std::string script = figures_script();
  char* arguments[] = {script.data(), folder.data(), nullptr};
  pid_t child = 0;
  int status = 0;
  sigset_t none;  // our threads block the signals that end a process; the script must not
  sigemptyset(&none);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const bool has_run = posix_spawn(&child, script.c_str(), nullptr, &attributes, arguments, environ) == 0 &&
                       waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
  posix_spawnattr_destroy(&attributes);
  if (!has_run) spdlog::warn("figures were not drawn; {}", figures_command(folder));
}

}  // namespace lapis::evaluator
