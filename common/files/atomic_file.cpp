#include "common/files/atomic_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace lapis::files {
namespace {

/// File descriptor that its destructor closes.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { close(); }
  bool is_open() const { return value_ >= 0; }
  int get() const { return value_; }
  /// Returns false on failure: some file systems report a full disk only when the file is closed.
  bool close() {
    const int result = value_ >= 0 ? ::close(value_) : 0;
    value_ = -1;
    return result == 0;
  }

 private:
  int value_;
};

std::string reason(const std::string& path, const char* what) {
  return path + ": " + what + ": " + std::strerror(errno);
}

bool write_all(int descriptor, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return true;
}

/// Writes the ".part" file of `path` and flushes it. Returns the reason on failure, which names `path`.
std::optional<std::string> write_part(const std::string& part, const std::string& path,
                                      std::span<const std::uint8_t> bytes) {
  Descriptor file(::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644));
  if (!file.is_open()) return reason(path, "cannot be created");
  if (!write_all(file.get(), bytes)) return reason(path, "cannot be written");
  if (::fsync(file.get()) != 0) return reason(path, "cannot be flushed");
  if (!file.close()) return reason(path, "cannot be closed");
  return std::nullopt;
}

}  // namespace

std::optional<std::string> replace_file(const std::string& path, std::span<const std::uint8_t> bytes) {
  const std::string part = path + ".part";
  std::optional<std::string> error = write_part(part, path, bytes);
  if (!error && ::rename(part.c_str(), path.c_str()) != 0) error = reason(path, "cannot be replaced");
  if (error) {
    ::unlink(part.c_str());
    return error;
  }
  // The new directory entry survives a power cut only when the folder is flushed. The file is replaced even where the
  // file system cannot do that.
  const std::string folder = std::filesystem::path(path).parent_path().string();
  const Descriptor directory(::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (directory.is_open()) ::fsync(directory.get());
  return std::nullopt;
}

std::optional<std::vector<std::uint8_t>> read_file(const std::string& path, std::string& error) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat info {};
  if (!file.is_open() || ::fstat(file.get(), &info) != 0) {
    error = reason(path, "cannot be opened");
    return std::nullopt;
  }
  if (!S_ISREG(info.st_mode)) {
    error = path + ": is not a file";
    return std::nullopt;
  }
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(info.st_size));
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t got = ::read(file.get(), bytes.data() + size, bytes.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) {
      error = reason(path, "cannot be read");
      return std::nullopt;
    }
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  bytes.resize(size);
  return bytes;
}

void replace_text(const std::filesystem::path& path, std::string_view text) {
  const std::vector<std::uint8_t> bytes(text.begin(), text.end());
  if (const auto problem = replace_file(path.string(), bytes)) throw std::runtime_error(*problem);
}

std::optional<std::string> set_aside(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  std::filesystem::path free = path;
  for (int i = 1; std::filesystem::exists(free, error); ++i) {
    free.replace_filename(path.stem().string() + "." + std::to_string(i) + path.extension().string());
  }
  std::filesystem::rename(path, free, error);
  if (error) return path.string() + ": cannot be set aside: " + error.message();
  return std::nullopt;
}

void require_writable_folder(const std::string& folder, const std::string& key) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error || !std::filesystem::is_directory(folder)) {
    throw std::runtime_error(key + ": " + folder + " is not a folder and cannot be made one: " + error.message());
  }
  // The file has a unique name because other processes may probe the same folder at the same time.
  std::string probe = (std::filesystem::path(folder) / ".lapis_writable_XXXXXX").string();
  const Descriptor file(::mkstemp(probe.data()));
  if (!file.is_open()) throw std::runtime_error(key + ": no file can be written there: " + reason(folder, "open"));
  std::filesystem::remove(probe, error);
}

}  // namespace lapis::files
