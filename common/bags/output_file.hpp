#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace lapis::bags {

/// Appends to a new file, each time with as few system calls as possible: after append() a kill of the process loses
/// nothing. All functions throw std::runtime_error, which names the file and the reason.
class OutputFile {
 public:
  /// The file must not exist.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void append(std::span<const std::uint8_t> bytes);
  /// Flushes to the disk and closes.
  void close();
  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  [[noreturn]] void fail(int error) const;

  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace lapis::bags
