#include "common/dds/shared_memory.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <thread>
#include <vector>

namespace lapis::dds {
namespace {

namespace fs = std::filesystem;

constexpr const char* kPrefix = "fastrtps_";
constexpr const char* kPortPrefix = "fastrtps_port";
constexpr const char* kLockSuffix = "_el";
constexpr const char* kTurnFile = "lapis_turn";
constexpr std::chrono::milliseconds kNap(10);   // while another process has its turn
constexpr std::uint64_t kRoomBeside = 1 << 20;  // for ports

/// A file that is closed at the end of its scope, and with it the lock on it.
class File {
 public:
  File(const fs::path& path, int flags) : file_(::open(path.c_str(), flags | O_CLOEXEC)) {}
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

/// Linux lets nobody open another user's file with O_CREAT in a folder such as /dev/shm.
int open_or_create(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  return file >= 0 || errno != ENOENT ? file : ::open(path.c_str(), O_RDONLY | O_CREAT | O_CLOEXEC, 0666);
}

void remove(const fs::path& path, SharedMemory::Reaped& reaped) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  if (error || !fs::remove(path, error) || error) return;
  ++reaped.files;
  reaped.bytes += bytes;
}

}  // namespace

SharedMemory::Reaped SharedMemory::reap(const Turn& turn) const {
  Reaped reaped;
  if (!turn.is_held()) return reaped;
  std::error_code error;
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_, error)) names.push_back(entry.path().filename().string());
  for (const std::string& name : names) {
    const bool is_lock_of_segment =
        name.starts_with(kPrefix) && !name.starts_with(kPortPrefix) && name.ends_with(kLockSuffix);
    if (!is_lock_of_segment || !is_own(folder_ / name)) continue;
    const File lock(folder_ / name, O_RDWR);
    if (!lock.lock()) continue;
    remove(folder_ / name.substr(0, name.size() - std::string(kLockSuffix).size()), reaped);
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

SharedMemory::Turn::Turn(const SharedMemory& memory, std::chrono::milliseconds patience)
    : file_(open_or_create(memory.folder_ / kTurnFile)) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (file_ >= 0) {
    is_held_ = ::flock(file_, LOCK_EX | LOCK_NB) == 0;
    if (is_held_ || std::chrono::steady_clock::now() >= deadline) return;
    std::this_thread::sleep_for(kNap);
  }
}

SharedMemory::Turn::~Turn() {
  if (file_ >= 0) ::close(file_);
}

}  // namespace lapis::dds
