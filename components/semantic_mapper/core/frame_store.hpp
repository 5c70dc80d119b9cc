#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/files/spill_file.hpp"
#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/votes/compact_frame.hpp"

namespace lapis::semantic_mapper {

struct FrameStoreConfig {
  int memory_mb = 1024;                ///< for packed frames and votes; the oldest ones beyond it go to disk
  std::string spill_dir = "/var/tmp";  ///< folder of the unnamed file for them
};

/// The frames of a map and the votes that each has in it, packed, in order of integration. Beyond the memory budget,
/// the oldest ones are on disk. A frame that the disk does not take is let go: its votes stay in the map for good.
class FrameStore {
 public:
  explicit FrameStore(FrameStoreConfig config) : config_(std::move(config)) {}

  void add(const mapping::CompactFrame& frame, const mapping::FrameVotes& votes);
  std::size_t size() const { return records_.size(); }
  /// False when the frame was let go.
  bool has(std::size_t index) const { return !records_[index].is_let_go; }
  /// Nothing, and the frame is let go, when it cannot be read back from disk.
  std::optional<mapping::CompactFrame> frame(std::size_t index);
  std::optional<mapping::FrameVotes> votes(std::size_t index);
  /// The samples as mapping::pack has packed them; nothing when the frame was let go or cannot be read back.
  std::optional<std::vector<std::uint8_t>> packed_frame(std::size_t index) const;
  /// False, and the frame is let go, when the votes have to go to disk and the disk does not take them.
  [[nodiscard]] bool replace_votes(std::size_t index, const mapping::FrameVotes& votes);

  std::size_t memory_bytes() const { return memory_bytes_; }
  std::uint64_t disk_bytes() const { return file_.bytes(); }
  std::size_t let_go() const { return let_go_; }
  /// Why the last frame was let go; empty when none was.
  const std::string& problem() const { return problem_; }

 private:
  /// Bytes in memory or, when there is an extent, on disk.
  struct Bytes {
    std::vector<std::uint8_t> memory;
    std::optional<files::SpillFile::Extent> disk;
  };
  struct Record {
    Bytes frame, votes;
    bool is_let_go = false;
  };

  std::optional<std::vector<std::uint8_t>> read(const Bytes& bytes) const;
  bool spill(Bytes& bytes);
  void drop(Bytes& bytes);
  void give_up(Record& record, std::string problem);
  void keep_budget();

  FrameStoreConfig config_;
  std::vector<Record> records_;
  std::size_t first_in_memory_ = 0;  ///< all records before it are on disk or let go
  std::size_t memory_bytes_ = 0;
  std::size_t let_go_ = 0;
  std::string problem_;
  files::SpillFile file_;
};

}  // namespace lapis::semantic_mapper
