#include "common/bags/mcap_records.hpp"

namespace lapis::bags::mcap {
namespace {

using files::ByteReader;
using files::ByteWriter;

void put_text(ByteWriter& out, const std::string& text) {
  out.u32(static_cast<std::uint32_t>(text.size()));
  out.raw({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

std::string text(ByteReader& in) {
  const auto bytes = in.raw(in.u32());
  return {bytes.begin(), bytes.end()};
}

/// Writes a record whose content `fill` writes, with its length before it.
template <class Fill>
void put_record(ByteWriter& out, Opcode opcode, const Fill& fill) {
  out.u8(static_cast<std::uint8_t>(opcode));
  const std::size_t at = out.bytes().size();
  out.u64(0);
  fill();
  out.set_u64(at, out.bytes().size() - at - 8);
}

/// Writes a list or map whose entries `fill` writes, with their length before them.
template <class Fill>
void put_entries(ByteWriter& out, const Fill& fill) {
  const std::size_t at = out.bytes().size();
  out.u32(0);
  fill();
  out.set_u32(at, static_cast<std::uint32_t>(out.bytes().size() - at - 4));
}

void put_texts(ByteWriter& out, const Texts& texts) {
  put_entries(out, [&] {
    for (const auto& [key, value] : texts) {
      put_text(out, key);
      put_text(out, value);
    }
  });
}

void put_numbers(ByteWriter& out, const std::map<std::uint16_t, std::uint64_t>& numbers) {
  put_entries(out, [&] {
    for (const auto& [key, value] : numbers) {
      out.u16(key);
      out.u64(value);
    }
  });
}

Texts texts(ByteReader& in) {
  ByteReader entries(in.raw(in.u32()));
  Texts found;
  while (entries.remaining() > 0) {
    const std::string key = text(entries);
    found[key] = text(entries);
  }
  if (!entries.is_good()) in.fail();
  return found;
}

std::map<std::uint16_t, std::uint64_t> numbers(ByteReader& in) {
  ByteReader entries(in.raw(in.u32()));
  std::map<std::uint16_t, std::uint64_t> found;
  while (entries.remaining() > 0) {
    const std::uint16_t key = entries.u16();
    found[key] = entries.u64();
  }
  if (!entries.is_good()) in.fail();
  return found;
}

template <class Content>
std::optional<Content> if_good(const ByteReader& in, Content content) {
  if (!in.is_good()) return std::nullopt;
  return content;
}

}  // namespace

void put(ByteWriter& out, const Header& record) {
  put_record(out, Opcode::kHeader, [&] {
    put_text(out, record.profile);
    put_text(out, record.library);
  });
}

void put(ByteWriter& out, const Footer& record) {
  put_record(out, Opcode::kFooter, [&] {
    out.u64(record.summary_start);
    out.u64(record.summary_offset_start);
    out.u32(record.summary_crc);
  });
}

void put(ByteWriter& out, const Schema& record) {
  put_record(out, Opcode::kSchema, [&] {
    out.u16(record.id);
    put_text(out, record.name);
    put_text(out, record.encoding);
    put_text(out, record.data);
  });
}

void put(ByteWriter& out, const Channel& record) {
  put_record(out, Opcode::kChannel, [&] {
    out.u16(record.id);
    out.u16(record.schema_id);
    put_text(out, record.topic);
    put_text(out, record.message_encoding);
    put_texts(out, record.metadata);
  });
}

void put(ByteWriter& out, const Message& record) {
  put_record(out, Opcode::kMessage, [&] {
    out.u16(record.channel_id);
    out.u32(record.sequence);
    out.u64(record.log_time);
    out.u64(record.publish_time);
    out.raw(record.data);
  });
}

void put(ByteWriter& out, const Chunk& record) {
  put_record(out, Opcode::kChunk, [&] {
    out.u64(record.start_time);
    out.u64(record.end_time);
    out.u64(record.uncompressed_size);
    out.u32(record.uncompressed_crc);
    put_text(out, record.compression);
    out.u64(record.records.size());
    out.raw(record.records);
  });
}

void put(ByteWriter& out, const MessageIndex& record) {
  put_record(out, Opcode::kMessageIndex, [&] {
    out.u16(record.channel_id);
    put_entries(out, [&] {
      for (const auto& [time, offset] : record.entries) {
        out.u64(time);
        out.u64(offset);
      }
    });
  });
}

void put(ByteWriter& out, const ChunkIndex& record) {
  put_record(out, Opcode::kChunkIndex, [&] {
    out.u64(record.start_time);
    out.u64(record.end_time);
    out.u64(record.offset);
    out.u64(record.length);
    put_numbers(out, record.message_index_offsets);
    out.u64(record.message_index_length);
    put_text(out, record.compression);
    out.u64(record.compressed_size);
    out.u64(record.uncompressed_size);
  });
}

void put(ByteWriter& out, const Statistics& record) {
  put_record(out, Opcode::kStatistics, [&] {
    out.u64(record.messages);
    out.u16(record.schemas);
    out.u32(record.channels);
    out.u32(record.attachments);
    out.u32(record.metadata);
    out.u32(record.chunks);
    out.u64(record.start_time);
    out.u64(record.end_time);
    put_numbers(out, record.channel_messages);
  });
}

void put(ByteWriter& out, const Metadata& record) {
  put_record(out, Opcode::kMetadata, [&] {
    put_text(out, record.name);
    put_texts(out, record.values);
  });
}

void put(ByteWriter& out, const MetadataIndex& record) {
  put_record(out, Opcode::kMetadataIndex, [&] {
    out.u64(record.offset);
    out.u64(record.length);
    put_text(out, record.name);
  });
}

void put(ByteWriter& out, const SummaryOffset& record) {
  put_record(out, Opcode::kSummaryOffset, [&] {
    out.u8(static_cast<std::uint8_t>(record.group));
    out.u64(record.start);
    out.u64(record.length);
  });
}

void put_data_end(ByteWriter& out) {
  put_record(out, Opcode::kDataEnd, [&] { out.u32(0); });
}

std::optional<Header> header(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  Header record;
  record.profile = text(in);
  record.library = text(in);
  return if_good(in, std::move(record));
}

std::optional<Footer> footer(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  Footer record;
  record.summary_start = in.u64();
  record.summary_offset_start = in.u64();
  record.summary_crc = in.u32();
  return if_good(in, record);
}

std::optional<Schema> schema(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  Schema record;
  record.id = in.u16();
  record.name = text(in);
  record.encoding = text(in);
  record.data = text(in);
  return if_good(in, std::move(record));
}

std::optional<Channel> channel(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  Channel record;
  record.id = in.u16();
  record.schema_id = in.u16();
  record.topic = text(in);
  record.message_encoding = text(in);
  record.metadata = texts(in);
  return if_good(in, std::move(record));
}

std::optional<Message> message(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  Message record;
  record.channel_id = in.u16();
  record.sequence = in.u32();
  record.log_time = in.u64();
  record.publish_time = in.u64();
  record.data = in.raw(in.remaining());
  return if_good(in, record);
}

std::optional<Chunk> chunk(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  Chunk record;
  record.start_time = in.u64();
  record.end_time = in.u64();
  record.uncompressed_size = in.u64();
  record.uncompressed_crc = in.u32();
  record.compression = text(in);
  record.records = in.raw(in.u64());
  return if_good(in, std::move(record));
}

std::optional<ChunkIndex> chunk_index(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  ChunkIndex record;
  record.start_time = in.u64();
  record.end_time = in.u64();
  record.offset = in.u64();
  record.length = in.u64();
  record.message_index_offsets = numbers(in);
  record.message_index_length = in.u64();
  record.compression = text(in);
  record.compressed_size = in.u64();
  record.uncompressed_size = in.u64();
  return if_good(in, std::move(record));
}

std::optional<Statistics> statistics(std::span<const std::uint8_t> content) {
  ByteReader in(content);
  Statistics record;
  record.messages = in.u64();
  record.schemas = in.u16();
  record.channels = in.u32();
  record.attachments = in.u32();
  record.metadata = in.u32();
  record.chunks = in.u32();
  record.start_time = in.u64();
  record.end_time = in.u64();
  record.channel_messages = numbers(in);
  return if_good(in, std::move(record));
}

std::optional<Record> take_record(std::span<const std::uint8_t>& bytes) {
  ByteReader in(bytes);
  const auto opcode = static_cast<Opcode>(in.u8());
  const auto content = in.raw(in.u64());
  if (!in.is_good()) return std::nullopt;
  bytes = bytes.subspan(kRecordHead + content.size());
  return Record{opcode, content};
}

}  // namespace lapis::bags::mcap
