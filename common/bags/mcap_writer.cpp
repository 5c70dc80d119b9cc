#include "common/bags/mcap_writer.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "common/files/crc32.hpp"
#include "common/files/zstd_codec.hpp"

namespace lapis::bags {
namespace {

constexpr const char* kLibrary = "lapis";

std::uint64_t unsigned_ns(std::int64_t ns) { return static_cast<std::uint64_t>(std::max<std::int64_t>(0, ns)); }

/// Appends the records of one kind, and says where they are.
template <class Records>
void put_group(files::ByteWriter& out, std::uint64_t start, mcap::Opcode group, const Records& records,
               std::vector<mcap::SummaryOffset>& offsets) {
  const std::uint64_t at = start + out.bytes().size();
  for (const auto& record : records) put(out, record);
  if (!records.empty()) offsets.push_back({group, at, start + out.bytes().size() - at});
}

}  // namespace

McapWriter::McapWriter(const std::filesystem::path& path, const McapOptions& options) : options_(options), file_(path) {
  files::ByteWriter out;
  out.raw(mcap::kMagic);
  put(out, mcap::Header{"ros2", kLibrary});
  file_.append(out.bytes());
}

std::uint16_t McapWriter::schema_id(const Channel& channel) {
  const auto known = std::find_if(schemas_.begin(), schemas_.end(), [&](const mcap::Schema& schema) {
    return schema.name == channel.type && schema.encoding == channel.schema_encoding && schema.data == channel.schema;
  });
  if (known != schemas_.end()) return known->id;
  const auto id = static_cast<std::uint16_t>(schemas_.size() + 1);
  schemas_.push_back({id, channel.type, channel.schema_encoding, channel.schema});
  files::ByteWriter out;
  put(out, schemas_.back());
  file_.append(out.bytes());
  return id;
}

std::size_t McapWriter::add_channel(const Channel& channel) {
  if (channels_.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw std::runtime_error(file_.path().string() + ": more channels than MCAP can number");
  }
  const auto id = static_cast<std::uint16_t>(channels_.size());
  channels_.push_back({id,
                       schema_id(channel),
                       channel.topic,
                       channel.encoding,
                       {{"offered_qos_profiles", channel.offered_qos}, {"topic_type_hash", channel.type_hash}}});
  files::ByteWriter out;
  put(out, channels_.back());
  file_.append(out.bytes());
  return id;
}

void McapWriter::write(const Message& message) {
  const auto id = static_cast<std::uint16_t>(message.channel);
  const std::uint64_t time = unsigned_ns(message.log_time_ns);
  mcap::MessageIndex& index = index_[id];
  if (index_.size() == 1 && index.entries.empty()) start_time_ = end_time_ = time;
  index.channel_id = id;
  index.entries.emplace_back(time, chunk_.bytes().size());
  start_time_ = std::min(start_time_, time);
  end_time_ = std::max(end_time_, time);
  put(chunk_, mcap::Message{id, message.sequence, time, unsigned_ns(message.publish_time_ns), message.data});
  if (chunk_.bytes().size() >= options_.chunk_bytes) write_chunk();
}

void McapWriter::flush() {
  if (!index_.empty()) write_chunk();
}

void McapWriter::write_chunk() {
  const std::vector<std::uint8_t> records = chunk_.take();
  std::vector<std::uint8_t> packed;
  if (options_.compression_level > 0) packed = files::zstd_compress(records, options_.compression_level);
  const bool is_packed = options_.compression_level > 0;
  const mcap::Chunk chunk{start_time_,
                          end_time_,
                          records.size(),
                          files::crc32(records),
                          is_packed ? "zstd" : "",
                          is_packed ? packed : records};
  files::ByteWriter out;
  out.reserve(chunk.records.size() + 1024);
  put(out, chunk);
  index_chunk(chunk, file_.size(), out.bytes().size(), out);
  index_.clear();
  chunk_ = {};
  file_.append(out.bytes());
}

/// Appends the message indexes of a chunk, and notes the chunk for the summary.
void McapWriter::index_chunk(const mcap::Chunk& chunk, std::uint64_t offset, std::uint64_t length,
                             files::ByteWriter& out) {
  mcap::ChunkIndex entry{.start_time = chunk.start_time,
                         .end_time = chunk.end_time,
                         .offset = offset,
                         .length = length,
                         .message_index_offsets = {},
                         .message_index_length = 0,
                         .compression = chunk.compression,
                         .compressed_size = chunk.records.size(),
                         .uncompressed_size = chunk.uncompressed_size};
  for (const auto& [id, index] : index_) {
    entry.message_index_offsets[id] = offset + out.bytes().size();
    put(out, index);
    statistics_.channel_messages[id] += index.entries.size();
    statistics_.messages += index.entries.size();
  }
  entry.message_index_length = out.bytes().size() - length;
  statistics_.start_time = chunks_.empty() ? chunk.start_time : std::min(statistics_.start_time, chunk.start_time);
  statistics_.end_time = std::max(statistics_.end_time, chunk.end_time);
  chunks_.push_back(std::move(entry));
}

void McapWriter::close() {
  flush();
  files::ByteWriter end;
  mcap::put_data_end(end);
  file_.append(end.bytes());

  statistics_.schemas = static_cast<std::uint16_t>(schemas_.size());
  statistics_.channels = static_cast<std::uint32_t>(channels_.size());
  statistics_.chunks = static_cast<std::uint32_t>(chunks_.size());
  const std::uint64_t start = file_.size();
  files::ByteWriter out;
  std::vector<mcap::SummaryOffset> offsets;
  put_group(out, start, mcap::Opcode::kSchema, schemas_, offsets);
  put_group(out, start, mcap::Opcode::kChannel, channels_, offsets);
  put_group(out, start, mcap::Opcode::kStatistics, std::vector{statistics_}, offsets);
  put_group(out, start, mcap::Opcode::kChunkIndex, chunks_, offsets);
  mcap::Footer footer{start, start + out.bytes().size(), 0};
  for (const mcap::SummaryOffset& offset : offsets) put(out, offset);
  files::ByteWriter tail = out;
  put(tail, footer);
  const std::size_t checked = tail.bytes().size() - sizeof footer.summary_crc;
  footer.summary_crc = files::crc32(std::span(tail.bytes()).first(checked));
  put(out, footer);
  out.raw(mcap::kMagic);
  file_.append(out.bytes());
  file_.close();
}

}  // namespace lapis::bags
