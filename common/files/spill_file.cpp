#include "common/files/spill_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace lapis::files {
namespace {

constexpr std::size_t kPage = 4096;

std::size_t capacity_of(std::size_t size) { return (size + kPage - 1) / kPage * kPage; }

/// Opens a file without a name. Where the file system does not support this, a named file is created and unlinked at
/// once.
int open_unnamed(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
  if (file >= 0 || (errno != EOPNOTSUPP && errno != EISDIR)) return file;
  std::string name = folder + "/lapis_spill_XXXXXX";
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) ::unlink(name.c_str());
  return named;
}

std::string reason(int error) { return std::generic_category().message(error); }

}  // namespace

SpillFile::SpillFile(SpillFile&& other) noexcept { *this = std::move(other); }

SpillFile& SpillFile::operator=(SpillFile&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(folder_, other.folder_);
  std::swap(end_, other.end_);
  std::swap(free_, other.free_);
  return *this;
}

SpillFile::~SpillFile() {
  if (file_ >= 0) ::close(file_);
}

std::optional<std::string> SpillFile::open(const std::string& folder) {
  folder_ = folder;
  file_ = open_unnamed(folder);
  if (file_ < 0) return "no temporary file in '" + folder + "': " + reason(errno);
  return std::nullopt;
}

std::uint64_t SpillFile::take_place(std::size_t capacity) {
  const auto free = free_.find(capacity);
  if (free == free_.end()) return std::exchange(end_, end_ + capacity);
  const std::uint64_t offset = free->second;
  free_.erase(free);
  return offset;
}

std::optional<SpillFile::Extent> SpillFile::write(std::span<const std::uint8_t> bytes, std::string& error) {
  const Extent extent{take_place(capacity_of(bytes.size())), bytes.size()};
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written =
        ::pwrite(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(extent.offset + done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      error = "temporary file in '" + folder_ + "': " + reason(written < 0 ? errno : ENOSPC);
      release(extent);
      return std::nullopt;
    }
    done += static_cast<std::size_t>(written);
  }
  return extent;
}

std::optional<std::vector<std::uint8_t>> SpillFile::read(const Extent& extent) const {
  std::vector<std::uint8_t> bytes(extent.size);
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got =
        ::pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(extent.offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return std::nullopt;
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

void SpillFile::release(const Extent& extent) { free_.emplace(capacity_of(extent.size), extent.offset); }

}  // namespace lapis::files
