#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "common/bags/bag.hpp"
#include "common/bags/mcap_records.hpp"
#include "common/bags/output_file.hpp"

namespace lapis::bags {

struct McapOptions {
  int compression_level = 1;              ///< of zstd; 0: chunks are not compressed
  std::uint64_t chunk_bytes = 1u << 20U;  ///< a chunk is written when its content is as large, before compression
};

/// Writes a file of MCAP with profile `ros2`: chunks with checksum and message indexes; summary with schemas, channels,
/// statistics and chunk indexes. Schemas and channels stand before the first chunk that needs them, so that a file
/// without a summary, of a killed recorder, can be read up to its last whole chunk.
class McapWriter : public StorageWriter {
 public:
  McapWriter(const std::filesystem::path& path, const McapOptions& options);

  std::size_t add_channel(const Channel& channel) override;
  void write(const Message& message) override;
  void flush() override;
  void close() override;
  std::uint64_t bytes() const override { return file_.size() + chunk_.bytes().size(); }

 private:
  std::uint16_t schema_id(const Channel& channel);
  void write_chunk();
  void index_chunk(const mcap::Chunk& chunk, std::uint64_t offset, std::uint64_t length, files::ByteWriter& out);

  McapOptions options_;
  OutputFile file_;
  std::vector<mcap::Schema> schemas_;    // ids from 1
  std::vector<mcap::Channel> channels_;  // ids from 0
  mcap::Statistics statistics_;
  std::vector<mcap::ChunkIndex> chunks_;
  // The chunk that is being filled:
  files::ByteWriter chunk_;
  std::map<std::uint16_t, mcap::MessageIndex> index_;
  std::uint64_t start_time_ = 0, end_time_ = 0;
};

}  // namespace lapis::bags
