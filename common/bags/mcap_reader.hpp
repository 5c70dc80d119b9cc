#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <queue>
#include <vector>

#include "common/bags/bag.hpp"
#include "common/bags/input_file.hpp"
#include "common/bags/mcap_records.hpp"

namespace lapis::bags {

/// Reads a file of MCAP: by its summary, or, where it has none that is whole (the recorder was killed) or its messages
/// are not in chunks, by going through all of it once. Memory: the chunks that overlap in time.
class McapReader : public StorageReader {
 public:
  /// Throws std::runtime_error, which names the file, when it is no MCAP file of version 0.
  explicit McapReader(const std::filesystem::path& path);

  const Contents& contents() const override { return contents_; }
  void select(const Selection& selection) override;
  std::optional<Message> next() override;

 private:
  /// A chunk, or a run of records outside of chunks.
  struct Block {
    std::uint64_t offset = 0, length = 0;        // in the file
    std::uint64_t start_time = 0, end_time = 0;  // of its messages
    std::vector<std::uint16_t> channels;         // that have messages in it
  };
  /// A message of a loaded block.
  struct Pending {
    std::uint64_t log_time = 0;
    std::size_t order = 0;  // in which it was loaded
    mcap::Message message;
    std::shared_ptr<const std::vector<std::uint8_t>> bytes;  // that message.data points into
    bool operator>(const Pending& other) const {
      return log_time != other.log_time ? log_time > other.log_time : order > other.order;
    }
  };
  /// What the records outside and inside of chunks say, while the file is scanned.
  struct Scan;

  bool is_closed() const;
  bool read_summary();
  bool take_summary_record(const mcap::Record& record, bool& has_statistics, mcap::Statistics& statistics);
  void scan();
  void scan_record(const mcap::Record& record, std::uint64_t offset, Scan& scan);
  void scan_message(const mcap::Message& message, Block& block);
  void note_channel(const mcap::Channel& channel);
  void finish_channels();
  bool is_wanted(std::uint16_t channel) const;
  bool may_be_wanted(const Block& block) const;
  void load(const Block& block);

  InputFile file_;
  Contents contents_;
  std::map<std::uint16_t, mcap::Schema> schemas_;
  std::map<std::uint16_t, mcap::Channel> channels_;
  std::map<std::uint16_t, std::uint64_t> counts_;
  std::map<std::uint16_t, std::size_t> indexes_;  // of channels in the contents
  std::vector<Block> blocks_;                     // by start time
  Selection selection_;
  std::size_t next_block_ = 0;
  std::size_t loaded_ = 0;  // messages so far
  std::priority_queue<Pending, std::vector<Pending>, std::greater<>> pending_;
};

}  // namespace lapis::bags
