#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"

struct zip;

namespace lapis::simulator {

/// The files in a zip archive, which stays open. Files that are larger than kMaxEntryBytes when unpacked are not read.
class ZipStore final : public AssetStore {
 public:
  static constexpr std::uint64_t kMaxEntryBytes = 256ULL << 20;

  /// @throws std::runtime_error naming file and remedy when it is missing, empty, truncated, no archive, or encrypted.
  explicit ZipStore(const std::filesystem::path& file);
  std::optional<std::vector<std::uint8_t>> read(const std::string& name) const override;
  std::vector<std::string> names() const override;
  std::string description() const override { return file_.string(); }

 private:
  struct Entry {
    std::uint64_t index = 0;
    std::uint64_t size = 0;  ///< unpacked [bytes]
  };
  struct Close {
    void operator()(zip* archive) const;
  };

  void list_entries();

  std::filesystem::path file_;
  std::unique_ptr<zip, Close> archive_;
  mutable std::mutex mutex_;  ///< libzip allows one reader at a time
  std::map<std::string, Entry> entries_;
};

}  // namespace lapis::simulator
