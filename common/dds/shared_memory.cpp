#include "common/dds/shared_memory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <set>
#include <system_error>
#include <vector>

namespace lapis::dds {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "fastrtps_";
constexpr const char* kPortPrefix = "fastrtps_port";
constexpr const char* kLockSuffix = "_el";
constexpr const char* kTurnFile = "lapis_turn";
constexpr std::uint64_t kRoomBeside = 1 << 20;  // for ports

/// A file that is closed at the end of its scope, and with it the lock on it.
class File {
 public:
  File(const fs::path& path, int flags) : file_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {}
  ~File() {
    if (file_ >= 0) ::close(file_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  bool lock() const { return file_ >= 0 && ::flock(file_, LOCK_EX | LOCK_NB) == 0; }

 private:
  int file_;
};

bool is_own(const fs::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == ::geteuid();
}

/// Files of a folder that any process which may be looked at has mapped.
std::set<std::string> mapped_files(const fs::path& folder) {
  std::set<std::string> mapped;
  std::error_code error;
  for (const auto& process : fs::directory_iterator("/proc", error)) {
    std::ifstream maps(process.path() / "maps");
    for (std::string line; std::getline(maps, line);) {
      const auto at = line.find(folder.string() + "/");
      if (at != std::string::npos) mapped.insert(line.substr(at));
    }
  }
  return mapped;
}

void remove(const fs::path& path, SharedMemory::Reaped& reaped) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error || !fs::remove(path, error) || error) return;
  ++reaped.files;
  reaped.bytes += bytes;
}

}  // namespace

SharedMemory::Reaped SharedMemory::reap() const {
  Reaped reaped;
  std::error_code error;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_, error)) names.push_back(entry.path().filename().string());
  const std::set<std::string> mapped = mapped_files(folder_);
  for (const std::string& name : names) {
    if (!name.starts_with(kPrefix) || !name.ends_with(kLockSuffix) || !is_own(folder_ / name)) continue;
    const std::string locked = name.substr(0, name.size() - std::string(kLockSuffix).size());
    // Other processes write to a port, and would not notice that it is another file now.
    if (locked.starts_with(kPortPrefix) && mapped.contains((folder_ / locked).string())) continue;
    const File lock(folder_ / name, O_RDWR);
    if (!lock.lock()) continue;
    remove(folder_ / locked, reaped);
    remove(folder_ / ("sem." + locked + "_mutex"), reaped);
    remove(folder_ / name, reaped);
  }
  return reaped;
}

std::string SharedMemory::obstacle(std::uint64_t segment_bytes) const {
  std::error_code error;
  const fs::space_info space = fs::space(folder_, error);
  if (error) return folder_.string() + " cannot be used: " + error.message();
  if (::access(folder_.c_str(), W_OK) != 0) return folder_.string() + " cannot be written";
  const std::uint64_t needed = segment_bytes + kRoomBeside;
  if (space.available >= needed) return "";
  return folder_.string() + " has " + std::to_string(space.available >> 20) + " MB left, and a participant needs " +
         std::to_string(needed >> 20) + " MB";
}

SharedMemory::Turn::Turn(const SharedMemory& memory)
    : file_(::open((memory.folder_ / kTurnFile).c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666)) {
  if (file_ >= 0) ::flock(file_, LOCK_EX);
}

SharedMemory::Turn::~Turn() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace lapis::dds
