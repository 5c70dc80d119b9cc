#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/bags/bag.hpp"
#include "common/bags/bag_metadata.hpp"
#include "common/bags/mcap_writer.hpp"

namespace lapis::bags {

enum class Storage { kMcap, kSqlite3 };

struct BagOptions {
  Storage storage = Storage::kMcap;
  McapOptions mcap;
  std::uint64_t split_bytes = 0;  ///< 0: never; a new file begins when the present one is as large
  double split_s = 0.0;           ///< 0: never; or when it spans as much time
};

/// Writes a bag of rosbag2: a folder with metadata.yaml and one or more files of storage, "<folder>_0.mcap" and so on.
/// metadata.yaml is replaced with each flush, so that a killed recording is a whole bag, too. Every function throws
/// std::runtime_error, which names the file, when it cannot be written.
class BagWriter {
 public:
  /// The folder must not exist, or be empty.
  BagWriter(const std::filesystem::path& folder, const BagOptions& options);

  std::size_t add_channel(const Channel& channel);
  void write(const Message& message);
  /// After it, a kill of the process loses nothing that was written so far.
  void flush();
  void close();

  const Contents& contents() const { return contents_; }
  const std::vector<FileSummary>& files() const { return files_; }

 private:
  void begin_file();
  bool is_full(const Message& message) const;
  void write_metadata() const;

  std::filesystem::path folder_;
  BagOptions options_;
  Contents contents_;
  std::vector<FileSummary> files_;
  std::unique_ptr<StorageWriter> file_;
};

/// "mcap" or "sqlite3".
const char* name_of(Storage storage);

}  // namespace lapis::bags
