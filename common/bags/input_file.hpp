#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace lapis::bags {

/// Reads parts of a file. All functions throw std::runtime_error, which names the file and the reason.
class InputFile {
 public:
  explicit InputFile(std::filesystem::path path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  /// Fewer bytes at the end of the file.
  std::vector<std::uint8_t> read(std::uint64_t offset, std::uint64_t size) const;
  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace lapis::bags
