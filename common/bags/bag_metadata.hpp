#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/bags/bag.hpp"

namespace lapis::bags {

/// What metadata.yaml of a bag's folder says, beside what its files say themselves.
struct BagMetadata {
  std::string storage;             ///< "mcap" or "sqlite3"
  std::string compression_format;  ///< "zstd", or empty
  std::string compression_mode;    ///< "file" or "message", in lower case; "none" or empty: not compressed
  std::vector<std::string> files;  ///< relative to the folder, in order of time
};

/// Reads metadata.yaml as rosbag2 writes it (versions 1 to 9). Throws std::runtime_error, which names the file and what
/// is wrong with it.
BagMetadata read_metadata(const std::filesystem::path& file);

/// A file of a bag that is being written.
struct FileSummary {
  std::string name;
  std::int64_t first_ns = 0, last_ns = 0;
  std::uint64_t messages = 0;
};

/// Text of metadata.yaml, version 8: QoS profiles are texts, as all readers since Foxy understand them.
std::string format_metadata(const std::string& storage, const Contents& contents,
                            const std::vector<FileSummary>& files);

}  // namespace lapis::bags
