#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "sensor_replay/core/tum_dataset.hpp"

namespace lapis::sensor_replay {

/// Decodes the frames of a range ahead of their use, in order, on its own thread. The result is the same as that of
/// calling the loader for one index after the other.
class FramePrefetcher {
 public:
  using Loader = std::function<LoadedFrame(std::size_t index)>;

  /// Starts decoding. At most `capacity` (at least 1) frames are decoded ahead of `next`. The loader is called on the
  /// prefetcher's thread only; objects that it refers to must outlive the prefetcher.
  FramePrefetcher(Loader loader, FrameRange range, std::size_t capacity = 4);
  /// Waits for the frame that is being decoded, if any, and drops the rest.
  ~FramePrefetcher();
  FramePrefetcher(const FramePrefetcher&) = delete;
  FramePrefetcher& operator=(const FramePrefetcher&) = delete;

  /// The next frame; waits until it is decoded. Empty after the last one. Call from one thread.
  /// @throws the exception of the loader, in place of the frame; after that, the range has ended.
  std::optional<LoadedFrame> next();

 private:
  void run();

  const Loader loader_;
  const FrameRange range_;
  const std::size_t capacity_;
  std::mutex mutex_;  // guards all members below except the thread
  std::condition_variable changed_;
  std::deque<LoadedFrame> decoded_;
  std::exception_ptr failure_;
  bool is_finished_ = false;
  bool is_stopped_ = false;
  std::thread worker_;  // last member, so that it starts when the others exist
};

}  // namespace lapis::sensor_replay
