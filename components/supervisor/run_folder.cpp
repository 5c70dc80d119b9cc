#include "supervisor/run_folder.hpp"

#include <fcntl.h>
#include <fnmatch.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>
#include <sstream>

#include "supervisor/program.hpp"

namespace lapis::supervisor {
namespace {

constexpr std::size_t kShownLines = 5;

/// PID of a process that holds a lock on the file, according to /proc/locks; 0: none is known.
pid_t holder_of(int file) {
  struct stat status {};
  if (fstat(file, &status) != 0) return 0;
  const std::string inode = ":" + std::to_string(status.st_ino);
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, sort, access, place;
    pid_t pid = 0;
    words >> number >> kind >> sort >> access >> pid >> place;
    if (kind == "FLOCK" && place.ends_with(inode)) return pid;
  }
  return 0;
}

/// The command line with which a run was started, as given by the launch script with --command; without it, the
/// process's own command line.
std::string command_of(pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/cmdline");
  std::string all;
  bool is_command = false;
  for (std::string word; std::getline(in, word, '\0');) {
    if (is_command) return word;
    is_command = word == "--command";
    all += (all.empty() ? "" : " ") + word;
  }
  return all;
}

std::string describe_holder(int file) {
  const pid_t pid = holder_of(file);
  if (pid == 0) return "another run";
  const std::string command = command_of(pid);
  return (command.empty() ? "a run that is ending" : command) + " (process " + std::to_string(pid) + ")";
}

bool is_kept(const std::filesystem::path& file, const std::vector<std::filesystem::path>& kept) {
  return std::any_of(kept.begin(), kept.end(), [&](const auto& other) {
    std::error_code error;
    return std::filesystem::equivalent(file, other, error);
  });
}

}  // namespace

RunFolder::RunFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  std::filesystem::create_directories(folder_ / "logs", error);
  if (!error) lock_ = open(folder_.c_str(), O_RDONLY | O_DIRECTORY);  // inherited by started processes
  if (lock_ < 0) {
    const std::string reason = error ? error.message() : std::strerror(errno);
    throw BadSetup(folder_.string() + " cannot be made a run folder: " + reason + "; choose another with --out DIR");
  }
  if (flock(lock_, LOCK_EX | LOCK_NB) == 0) return;
  const std::string holder = describe_holder(lock_);
  close(lock_);
  throw BadSetup(folder_.string() + " is in use by " + holder + "; wait for its end, or choose another with --out DIR");
}

RunFolder::~RunFolder() { close(lock_); }

void RunFolder::clear(const std::vector<std::string>& patterns, const std::vector<std::filesystem::path>& kept) const {
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_)) {
    const std::string name = entry.path().lexically_relative(folder_).string();
    const auto matches = [&](const auto& pattern) { return fnmatch(pattern.c_str(), name.c_str(), FNM_PATHNAME) == 0; };
    const bool is_file = entry.is_symlink() || entry.is_regular_file();
    if (is_file && std::any_of(patterns.begin(), patterns.end(), matches) && !is_kept(entry.path(), kept)) {
      old.push_back(entry.path());
    }
  }
  for (const auto& file : old) std::filesystem::remove(file);
}

std::string RunFolder::end_of_log(const std::string& process) const {
  std::ifstream in(log(process));
  std::deque<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    lines.push_back(line);
    if (lines.size() > kShownLines) lines.pop_front();
  }
  std::string text;
  for (const auto& line : lines) text += line + "\n";
  return text;
}

}  // namespace lapis::supervisor
