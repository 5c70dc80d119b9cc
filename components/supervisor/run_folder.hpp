#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lapis::supervisor {

/// The folder of a run, which nobody else may use until the run's last process has ended.
class RunFolder {
 public:
  /// Makes the folder and its logs/ and takes its lock. Throws BadSetup when it cannot be made, or when another run has
  /// it, which is named. The lock is the system's (flock on the folder): started processes hold it, too, and nothing of
  /// it is left behind.
  explicit RunFolder(std::filesystem::path folder);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Removes what an earlier run has left: files that match a pattern (of its path in the folder; * and ? stay within a
  /// name), but for the files in `kept`.
  void clear(const std::vector<std::string>& patterns, const std::vector<std::filesystem::path>& kept) const;

  const std::filesystem::path& path() const { return folder_; }
  std::filesystem::path log(const std::string& process) const { return folder_ / "logs" / (process + ".log"); }
  /// The last lines of a process's log.
  std::string end_of_log(const std::string& process) const;

 private:
  std::filesystem::path folder_;
  int lock_ = -1;
};

}  // namespace lapis::supervisor
