#include "common/bags/mcap_reader.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "common/bags/chunk_codec.hpp"
#include "common/files/crc32.hpp"

namespace lapis::bags {
namespace {

// A chunk of uncompressed images may be large; a record that claims more is damaged.
constexpr std::uint64_t kMostRecord = std::uint64_t{2} << 30;

std::int64_t signed_ns(std::uint64_t ns) {
  return static_cast<std::int64_t>(std::min<std::uint64_t>(ns, std::numeric_limits<std::int64_t>::max()));
}

std::vector<std::uint8_t> records_of(const mcap::Chunk& chunk) {
  std::vector<std::uint8_t> records = unpack(chunk.compression, chunk.records, chunk.uncompressed_size);
  if (chunk.uncompressed_crc != 0 && files::crc32(records) != chunk.uncompressed_crc) {
    throw std::runtime_error("a chunk whose checksum is wrong");
  }
  return records;
}

}  // namespace

struct McapReader::Scan {
  std::optional<Block> open;  // a run of records outside of chunks
  std::size_t damaged = 0;    // chunks
};

McapReader::McapReader(const std::filesystem::path& path) : file_(path) {
  const auto magic = file_.read(0, mcap::kMagic.size());
  if (!std::equal(magic.begin(), magic.end(), mcap::kMagic.begin(), mcap::kMagic.end())) {
    file_.fail("is no MCAP file of version 0");
  }
  if (!read_summary()) scan();
  if (!is_closed()) {
    contents_.notes.push_back(path.filename().string() +
                              " was not closed (did its writer die?): what is whole in it is read");
  }
  finish_channels();
  std::stable_sort(blocks_.begin(), blocks_.end(),
                   [](const Block& a, const Block& b) { return a.start_time < b.start_time; });
  for (const Block& block : blocks_) {
    if (block.channels.empty()) continue;
    const bool is_first = contents_.first_ns == 0 && contents_.last_ns == 0;
    contents_.first_ns = is_first ? signed_ns(block.start_time) : contents_.first_ns;
    contents_.last_ns = std::max(contents_.last_ns, signed_ns(block.end_time));
  }
  select({});
}

bool McapReader::is_closed() const {
  const auto end =
      file_.read(file_.size() - std::min<std::uint64_t>(file_.size(), mcap::kMagic.size()), mcap::kMagic.size());
  return file_.size() > mcap::kMagic.size() && std::equal(end.begin(), end.end(), mcap::kMagic.begin());
}

/// False when there is no whole summary that says all.
bool McapReader::read_summary() {
  const std::size_t tail_size = mcap::kFooterSize + mcap::kMagic.size();
  if (file_.size() < mcap::kMagic.size() + tail_size) return false;
  const std::uint64_t footer_at = file_.size() - tail_size;
  const auto tail = file_.read(footer_at, tail_size);
  if (!std::equal(mcap::kMagic.begin(), mcap::kMagic.end(), tail.begin() + mcap::kFooterSize)) return false;
  std::span<const std::uint8_t> bytes(tail);
  const auto record = mcap::take_record(bytes);
  const auto footer = record && record->opcode == mcap::Opcode::kFooter ? mcap::footer(record->content) : std::nullopt;
  if (!footer || footer->summary_start < mcap::kMagic.size() || footer->summary_start >= footer_at) return false;
  const auto summary = file_.read(footer->summary_start, footer_at - footer->summary_start);
  if (footer->summary_crc != 0) {
    std::vector<std::uint8_t> checked = summary;
    checked.insert(checked.end(), tail.begin(), tail.begin() + mcap::kFooterSize - sizeof footer->summary_crc);
    if (files::crc32(checked) != footer->summary_crc) return false;
  }
  bool has_statistics = false;
  mcap::Statistics statistics;
  std::span<const std::uint8_t> rest(summary);
  while (!rest.empty()) {
    const auto found = mcap::take_record(rest);
    if (!found || !take_summary_record(*found, has_statistics, statistics)) return false;
  }
  counts_ = statistics.channel_messages;
  const auto is_known = [&](const auto& count) { return channels_.contains(count.first); };
  const bool is_complete = has_statistics && std::all_of(counts_.begin(), counts_.end(), is_known) &&
                           blocks_.size() == statistics.chunks && (statistics.messages == 0 || !blocks_.empty());
  if (!is_complete) {
    blocks_.clear();
    counts_.clear();
  }
  return is_complete;
}

bool McapReader::take_summary_record(const mcap::Record& record, bool& has_statistics, mcap::Statistics& statistics) {
  if (record.opcode == mcap::Opcode::kSchema) {
    const auto schema = mcap::schema(record.content);
    if (schema) schemas_[schema->id] = *schema;
    return schema.has_value();
  }
  if (record.opcode == mcap::Opcode::kChannel) {
    const auto channel = mcap::channel(record.content);
    if (channel) note_channel(*channel);
    return channel.has_value();
  }
  if (record.opcode == mcap::Opcode::kStatistics) {
    const auto found = mcap::statistics(record.content);
    has_statistics = found.has_value();
    if (found) statistics = *found;
    return has_statistics;
  }
  if (record.opcode != mcap::Opcode::kChunkIndex) return true;
  const auto index = mcap::chunk_index(record.content);
  if (!index) return false;
  Block block{index->offset, index->length, index->start_time, index->end_time, {}};
  for (const auto& [id, offset] : index->message_index_offsets) block.channels.push_back(id);
  blocks_.push_back(std::move(block));
  return true;
}

/// Goes through the whole file, and through the content of every chunk.
void McapReader::scan() {
  Scan scan;
  std::uint64_t at = mcap::kMagic.size();
  bool is_at_end = false;
  while (!is_at_end) {
    const auto head = file_.read(at, mcap::kRecordHead);
    files::ByteReader in(head);
    const auto opcode = static_cast<mcap::Opcode>(in.u8());
    const std::uint64_t length = in.u64();
    const bool is_whole = in.is_good() && length <= kMostRecord && length <= file_.size() - at - mcap::kRecordHead;
    is_at_end = !is_whole || opcode == mcap::Opcode::kFooter || opcode == mcap::Opcode::kDataEnd;
    if (is_at_end) break;
    const auto content = file_.read(at + mcap::kRecordHead, length);
    scan_record({opcode, content}, at, scan);
    at += mcap::kRecordHead + length;
    if (scan.open) scan.open->length = at - scan.open->offset;
  }
  if (scan.open && !scan.open->channels.empty()) blocks_.push_back(*scan.open);
  if (scan.damaged > 0) {
    contents_.notes.push_back(file_.path().filename().string() + ": " + std::to_string(scan.damaged) +
                              " damaged chunks are left out");
  }
}

void McapReader::scan_record(const mcap::Record& record, std::uint64_t offset, Scan& scan) {
  if (record.opcode != mcap::Opcode::kChunk) {
    if (!scan.open) scan.open = Block{offset, 0, 0, 0, {}};
    if (record.opcode == mcap::Opcode::kSchema) {
      if (const auto schema = mcap::schema(record.content)) schemas_[schema->id] = *schema;
    } else if (record.opcode == mcap::Opcode::kChannel) {
      if (const auto channel = mcap::channel(record.content)) note_channel(*channel);
    } else if (record.opcode == mcap::Opcode::kMessage) {
      if (const auto message = mcap::message(record.content)) scan_message(*message, *scan.open);
    }
    return;
  }
  if (scan.open && !scan.open->channels.empty()) blocks_.push_back(*scan.open);
  scan.open.reset();
  try {
    const auto chunk = mcap::chunk(record.content);
    if (!chunk) throw std::runtime_error("a chunk that is too short");
    const auto records = records_of(*chunk);
    Scan inside{Block{offset, mcap::kRecordHead + record.content.size(), 0, 0, {}}, 0};
    std::span<const std::uint8_t> rest(records);
    while (!rest.empty()) {
      const auto found = mcap::take_record(rest);
      if (!found || found->opcode == mcap::Opcode::kChunk) throw std::runtime_error("a chunk of damaged records");
      scan_record(*found, offset, inside);
    }
    if (!inside.open->channels.empty()) blocks_.push_back(*inside.open);
  } catch (const std::runtime_error&) {
    ++scan.damaged;
  }
}

void McapReader::scan_message(const mcap::Message& message, Block& block) {
  if (!channels_.contains(message.channel_id)) return;
  block.start_time = block.channels.empty() ? message.log_time : std::min(block.start_time, message.log_time);
  block.end_time = block.channels.empty() ? message.log_time : std::max(block.end_time, message.log_time);
  ++counts_[message.channel_id];
  const bool is_known =
      std::find(block.channels.begin(), block.channels.end(), message.channel_id) != block.channels.end();
  if (!is_known) block.channels.push_back(message.channel_id);
}

void McapReader::note_channel(const mcap::Channel& channel) { channels_.emplace(channel.id, channel); }

void McapReader::finish_channels() {
  for (const auto& [id, channel] : channels_) {
    const auto schema = schemas_.find(channel.schema_id);
    const auto value = [&](const char* key) {
      const auto found = channel.metadata.find(key);
      return found == channel.metadata.end() ? std::string() : found->second;
    };
    indexes_[id] = contents_.channels.size();
    contents_.channels.push_back({.topic = channel.topic,
                                  .type = schema == schemas_.end() ? "" : schema->second.name,
                                  .encoding = channel.message_encoding,
                                  .schema_encoding = schema == schemas_.end() ? "" : schema->second.encoding,
                                  .schema = schema == schemas_.end() ? "" : schema->second.data,
                                  .type_hash = value("topic_type_hash"),
                                  .offered_qos = value("offered_qos_profiles")});
    contents_.message_counts.push_back(counts_.contains(id) ? counts_[id] : 0);
  }
}

void McapReader::select(const Selection& selection) {
  selection_ = selection;
  next_block_ = loaded_ = 0;
  pending_ = {};
}

bool McapReader::is_wanted(std::uint16_t channel) const {
  const auto known = channels_.find(channel);
  return known != channels_.end() && (!selection_.topics || selection_.topics->contains(known->second.topic));
}

bool McapReader::may_be_wanted(const Block& block) const {
  if (selection_.from_ns && signed_ns(block.end_time) < *selection_.from_ns) return false;
  if (selection_.to_ns && signed_ns(block.start_time) > *selection_.to_ns) return false;
  return std::any_of(block.channels.begin(), block.channels.end(), [&](auto id) { return is_wanted(id); });
}

void McapReader::load(const Block& block) {
  auto bytes = std::make_shared<std::vector<std::uint8_t>>(file_.read(block.offset, block.length));
  std::span<const std::uint8_t> rest(*bytes);
  std::span<const std::uint8_t> first(*bytes);
  const auto record = mcap::take_record(first);
  if (!record) throw std::runtime_error("no whole record where the summary says that a chunk is");
  if (record->opcode == mcap::Opcode::kChunk) {
    const auto chunk = mcap::chunk(record->content);
    if (!chunk) throw std::runtime_error("a chunk that is too short");
    bytes = std::make_shared<std::vector<std::uint8_t>>(records_of(*chunk));
    rest = *bytes;
  }
  while (!rest.empty()) {
    const auto found = mcap::take_record(rest);
    if (!found) throw std::runtime_error("a chunk of damaged records");
    const auto message = found->opcode == mcap::Opcode::kMessage ? mcap::message(found->content) : std::nullopt;
    if (!message || !is_wanted(message->channel_id)) continue;
    const std::int64_t time_ns = signed_ns(message->log_time);
    if (selection_.from_ns && time_ns < *selection_.from_ns) continue;
    if (selection_.to_ns && time_ns > *selection_.to_ns) continue;
    pending_.push({message->log_time, loaded_++, *message, bytes});
  }
}

std::optional<Message> McapReader::next() {
  while (next_block_ < blocks_.size() &&
         (pending_.empty() || blocks_[next_block_].start_time <= pending_.top().log_time)) {
    const Block& block = blocks_[next_block_++];
    if (!may_be_wanted(block)) continue;
    try {
      load(block);
    } catch (const std::runtime_error& error) {
      file_.fail("at byte " + std::to_string(block.offset) + ": " + error.what());
    }
  }
  if (pending_.empty()) return std::nullopt;
  const Pending& first = pending_.top();
  Message message{indexes_.at(first.message.channel_id),
                  first.message.sequence,
                  signed_ns(first.message.log_time),
                  signed_ns(first.message.publish_time),
                  {first.message.data.begin(), first.message.data.end()}};
  pending_.pop();
  return message;
}

}  // namespace lapis::bags
