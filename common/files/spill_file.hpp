#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lapis::files {

/// Stores bytes on disk in a file without a name, so that nothing is left behind, however the process ends. The space
/// of released extents is reused.
class SpillFile {
 public:
  /// Position of stored bytes in the file.
  struct Extent {
    std::uint64_t offset = 0;
    std::size_t size = 0;
  };

  SpillFile() = default;
  SpillFile(const SpillFile&) = delete;
  SpillFile& operator=(const SpillFile&) = delete;
  SpillFile(SpillFile&& other) noexcept;
  SpillFile& operator=(SpillFile&& other) noexcept;
  ~SpillFile();

  /// Returns nothing on success, otherwise the reason why no file can be created in the folder.
  [[nodiscard]] std::optional<std::string> open(const std::string& folder);
  bool is_open() const { return file_ >= 0; }
  /// Returns nothing when the bytes cannot be written (`error` names the folder and gives the reason); bytes stored
  /// before stay intact.
  std::optional<Extent> write(std::span<const std::uint8_t> bytes, std::string& error);
  /// Returns nothing when the bytes cannot be read.
  std::optional<std::vector<std::uint8_t>> read(const Extent& extent) const;
  void release(const Extent& extent);
  /// Length of the file [bytes].
  std::uint64_t bytes() const { return end_; }

 private:
  std::uint64_t take_place(std::size_t capacity);

  int file_ = -1;
  std::string folder_;
  std::uint64_t end_ = 0;
  std::multimap<std::size_t, std::uint64_t> free_;  ///< capacity, offset
};

}  // namespace lapis::files
