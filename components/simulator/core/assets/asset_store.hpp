#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace lapis::simulator {

/// Files by name, from a folder or from an archive. Reading from several threads at once is allowed.
class AssetStore {
 public:
  virtual ~AssetStore() = default;
  /// Content of a file; nothing when there is none of that name or it cannot be read. Names use '/'.
  virtual std::optional<std::vector<std::uint8_t>> read(const std::string& name) const = 0;
  /// All file names, sorted.
  virtual std::vector<std::string> names() const = 0;
  /// Path of the folder or archive, for messages.
  virtual std::string description() const = 0;
};

/// The files below a folder. Names that lead out of it ("../x", "/x") are never read.
class FolderStore final : public AssetStore {
 public:
  explicit FolderStore(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::optional<std::vector<std::uint8_t>> read(const std::string& name) const override;
  std::vector<std::string> names() const override;
  std::string description() const override { return folder_.string(); }

 private:
  std::filesystem::path folder_;
};

}  // namespace lapis::simulator
