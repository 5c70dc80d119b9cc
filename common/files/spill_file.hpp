#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lapis::files {

/// Bytes on disk in a file without a name: nothing is left behind, however the process ends. The place of what is
/// released is used again.
class SpillFile {
 public:
  /// Where some bytes are.
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

  /// Nothing on success; otherwise why there can be no file in the folder.
  [[nodiscard]] std::optional<std::string> open(const std::string& folder);
  bool is_open() const { return file_ >= 0; }
  /// Nothing when the bytes could not be written (`error` names the folder and says why); what is there stays whole.
  std::optional<Extent> write(std::span<const std::uint8_t> bytes, std::string& error);
  /// Nothing when the disk does not give them back.
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
