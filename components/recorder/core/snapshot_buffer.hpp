#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "common/bags/bag.hpp"

namespace lapis::recorder {

/// The newest messages, over a span of time and within a bound of memory. The last message of each latched channel is
/// kept however old it is, because readers of a snapshot need it (transforms, intrinsics, names of labels).
class SnapshotBuffer {
 public:
  /// @param span_ns between the oldest and the newest message; @param most_bytes of all messages together
  SnapshotBuffer(std::int64_t span_ns, std::uint64_t most_bytes) : span_ns_(span_ns), most_bytes_(most_bytes) {}

  void add(bags::Message message, bool is_latched);
  /// All of it in the order of log times; latched messages that are older than the others get the time of the oldest.
  /// The buffer is empty then, but for those.
  std::vector<bags::Message> take();
  std::size_t size() const { return messages_.size(); }
  std::uint64_t bytes() const { return bytes_; }

 private:
  void drop_oldest();

  std::int64_t span_ns_;
  std::uint64_t most_bytes_;
  std::deque<bags::Message> messages_;  // in the order in which they came
  std::vector<bags::Message> latched_;  // the newest of each latched channel that is not among them any more
  std::vector<bool> is_latched_;        // by channel
  std::uint64_t bytes_ = 0;
};

}  // namespace lapis::recorder
