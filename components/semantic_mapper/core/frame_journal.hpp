#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "common/mapping/votes/compact_frame.hpp"
#include "semantic_mapper/core/semantic_mapper.hpp"

namespace lapis::semantic_mapper {

/// What a journal of frames holds; docs/frames_file.md describes its layout.
struct JournalSummary {
  std::int64_t session = 0;  ///< session of slam to which its key-frames belong
  std::size_t frames = 0;
  std::uint64_t end = 0;      ///< where the last whole frame ends [bytes from the beginning of the file]
  std::uint64_t dropped = 0;  ///< bytes after that: a frame that its process did not live to write, or damage
};

/// Receives a frame of a journal; false when it cannot be used, and the journal is to end before it.
using JournalVisitor = std::function<bool(const FrameRecord& record, mapping::CompactFrame samples)>;

/// Gives the frames of a journal, in their order, to `visit`. A frame that is torn, damaged, impossible or refused by
/// `visit` ends the journal. The memory is that of the largest frame. Returns nothing, with a reason in `error` that
/// names the file, when the file cannot be read or is no journal of this version.
std::optional<JournalSummary> read_frame_journal(const std::string& path, const JournalVisitor& visit,
                                                 std::string& error);

/// True when a file can be read and begins as a journal does.
bool is_frame_journal(const std::string& path);

/// Appends the frames of a map to a file, from which another process can build the map again. What was appended
/// outlives a process that is killed, but not a loss of power: nothing is flushed to the disk.
class FrameJournal {
 public:
  /// `end`: JournalSummary::end of the file at `path`, which is to be continued in the same session; 0: the first frame
  /// begins a new file, which replaces what is there.
  FrameJournal(std::string path, std::int64_t session, std::uint64_t end = 0);
  ~FrameJournal();
  FrameJournal(const FrameJournal&) = delete;
  FrameJournal& operator=(const FrameJournal&) = delete;

  /// `packed`: the samples as mapping::pack packs them. When they cannot be written, returns the reason, which names
  /// the file; the file then ends with the frame before, and the next frame is appended there.
  [[nodiscard]] std::optional<std::string> append(const FrameRecord& record, std::span<const std::uint8_t> packed);

  /// Removes the file.
  void remove();

 private:
  std::optional<std::string> open();
  std::optional<std::string> write(std::span<const std::uint8_t> bytes);
  std::string reason(const char* what) const;
  void close();

  std::string path_;
  std::int64_t session_;
  std::uint64_t end_;  ///< of the last whole frame
  int file_ = -1;      ///< open only while nothing follows that frame
};

}  // namespace lapis::semantic_mapper
