#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lapis::supervisor {

/// The folder of a run, which no other run may use until the last process of the run has ended.
class RunFolder {
 public:
  /// Creates the folder with its logs/ and locks it. Throws BadSetup when it cannot be created, or when another run,
  /// which is named, uses it. The lock is an flock on the folder: started processes hold it, too, and it leaves nothing
  /// behind.
  explicit RunFolder(std::filesystem::path folder);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  /// Removes the files of an earlier run: those whose path in the folder matches a pattern (* and ? do not match a
  /// slash), except the files in `kept`.
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
