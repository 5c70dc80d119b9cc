#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>

#include "common/bags/bag_writer.hpp"

namespace lapis::recorder {

/// Writes a bag in a thread of its own, and flushes it every second. For use by one thread.
class RecordingWorker {
 public:
  /// Throws std::runtime_error when the bag cannot be begun.
  RecordingWorker(const std::filesystem::path& folder, const bags::BagOptions& options, std::uint64_t most_bytes);
  ~RecordingWorker();

  std::size_t add_channel(const bags::Channel& channel);
  /// False when there is no room in memory for another message; `waits`: waits for room.
  bool write(bags::Message message, bool waits);
  /// Waits until all is written, and completes the bag.
  void close();
  /// Why the bag cannot be written any more, if it is so.
  std::optional<std::string> failure() const;
  std::uint64_t written() const;

 private:
  using Job = std::variant<bags::Channel, bags::Message>;
  void run();
  void work(std::deque<Job> jobs, bool is_last);

  bags::BagWriter writer_;  // of the thread, once it runs
  const std::uint64_t most_bytes_;
  std::size_t channels_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_;
  std::uint64_t waiting_bytes_ = 0, written_ = 0;
  bool is_ending_ = false;
  std::optional<std::string> failure_;
  std::jthread thread_;  // last member, because it uses the others
};

}  // namespace lapis::recorder
