#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "common/files/byte_stream.hpp"

/// The records of an MCAP file (mcap.dev/spec, version 0). Numbers are little-endian; texts and maps have their length
/// in bytes before them (u32).
namespace lapis::bags::mcap {

inline constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Opcode : std::uint8_t {
  kHeader = 1,
  kFooter = 2,
  kSchema = 3,
  kChannel = 4,
  kMessage = 5,
  kChunk = 6,
  kMessageIndex = 7,
  kChunkIndex = 8,
  kAttachment = 9,
  kAttachmentIndex = 10,
  kStatistics = 11,
  kMetadata = 12,
  kMetadataIndex = 13,
  kSummaryOffset = 14,
  kDataEnd = 15,
};

/// Opcode and length (u64) before the content of each record [bytes].
inline constexpr std::size_t kRecordHead = 9;

using Texts = std::map<std::string, std::string>;

struct Header {
  std::string profile, library;
};
struct Footer {
  std::uint64_t summary_start = 0;         ///< 0: none
  std::uint64_t summary_offset_start = 0;  ///< 0: none
  std::uint32_t summary_crc = 0;           ///< from the start of the summary to the previous field; 0: not computed
};
struct Schema {
  std::uint16_t id = 0;
  std::string name, encoding, data;
};
struct Channel {
  std::uint16_t id = 0, schema_id = 0;
  std::string topic, message_encoding;
  Texts metadata;
};
struct Message {
  std::uint16_t channel_id = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;  // ns
  std::span<const std::uint8_t> data;
};
struct Chunk {
  std::uint64_t start_time = 0, end_time = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;  ///< 0: not computed
  std::string compression;             ///< "", "zstd" or "lz4"
  std::span<const std::uint8_t> records;
};
struct MessageIndex {
  std::uint16_t channel_id = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  ///< log time, offset in the uncompressed chunk
};
struct ChunkIndex {
  std::uint64_t start_time = 0, end_time = 0;
  std::uint64_t offset = 0, length = 0;                          ///< of the chunk record in the file
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;  ///< per channel
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
};
struct Statistics {
  std::uint64_t messages = 0;
  std::uint16_t schemas = 0;
  std::uint32_t channels = 0, attachments = 0, metadata = 0, chunks = 0;
  std::uint64_t start_time = 0, end_time = 0;
  std::map<std::uint16_t, std::uint64_t> channel_messages;
};
struct Metadata {
  std::string name;
  Texts values;
};
struct MetadataIndex {
  std::uint64_t offset = 0, length = 0;
  std::string name;
};
struct SummaryOffset {
  Opcode group{};
  std::uint64_t start = 0, length = 0;
};

void put(files::ByteWriter& out, const Header& record);
void put(files::ByteWriter& out, const Footer& record);
void put(files::ByteWriter& out, const Schema& record);
void put(files::ByteWriter& out, const Channel& record);
void put(files::ByteWriter& out, const Message& record);
void put(files::ByteWriter& out, const Chunk& record);
void put(files::ByteWriter& out, const MessageIndex& record);
void put(files::ByteWriter& out, const ChunkIndex& record);
void put(files::ByteWriter& out, const Statistics& record);
void put(files::ByteWriter& out, const Metadata& record);
void put(files::ByteWriter& out, const MetadataIndex& record);
void put(files::ByteWriter& out, const SummaryOffset& record);
/// Without a checksum of the data section (0): chunks have their own.
void put_data_end(files::ByteWriter& out);

/// Contents of records; nothing when one is too short. Bytes after the known fields are ignored, as the specification
/// wants it. Spans point into `content`.
std::optional<Header> header(std::span<const std::uint8_t> content);
std::optional<Footer> footer(std::span<const std::uint8_t> content);
std::optional<Schema> schema(std::span<const std::uint8_t> content);
std::optional<Channel> channel(std::span<const std::uint8_t> content);
std::optional<Message> message(std::span<const std::uint8_t> content);
std::optional<Chunk> chunk(std::span<const std::uint8_t> content);
std::optional<ChunkIndex> chunk_index(std::span<const std::uint8_t> content);
std::optional<Statistics> statistics(std::span<const std::uint8_t> content);

/// A record within bytes.
struct Record {
  Opcode opcode{};
  std::span<const std::uint8_t> content;
};
/// Takes the first record from `bytes`; nothing when there is no whole one.
std::optional<Record> take_record(std::span<const std::uint8_t>& bytes);

/// Size of the footer record with its head [bytes].
inline constexpr std::size_t kFooterSize = kRecordHead + 20;

}  // namespace lapis::bags::mcap
