#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bags/bag.hpp"

namespace lapis::bags {

/// True for what BagReader may be able to read: a folder with metadata.yaml or with files of bags, or such a file.
bool looks_like_a_bag(const std::filesystem::path& path);

/// Reads a bag of rosbag2: a folder, or a single file (.mcap, .db3, also compressed as a whole: .zstd), MCAP or SQLite,
/// and messages that are compressed one by one. Files that are split are read as one.
class BagReader : public StorageReader {
 public:
  /// Throws std::runtime_error, which names the file and what is wrong with it.
  explicit BagReader(const std::filesystem::path& path);
  ~BagReader() override;
  BagReader(BagReader&&) noexcept;

  const Contents& contents() const override { return contents_; }
  void select(const Selection& selection) override;
  std::optional<Message> next() override;

 private:
  struct File;
  void open(const std::filesystem::path& path);
  void merge(const Contents& contents, File& file);

  Contents contents_;
  std::vector<std::unique_ptr<File>> files_;  // by time of the first message
  bool has_compressed_messages_ = false;
};

}  // namespace lapis::bags
