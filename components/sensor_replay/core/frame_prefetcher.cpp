#include "sensor_replay/core/frame_prefetcher.hpp"

#include <algorithm>
#include <utility>

namespace lapis::sensor_replay {

FramePrefetcher::FramePrefetcher(Loader loader, FrameRange range, std::size_t capacity)
    : loader_(std::move(loader)), range_(range), capacity_(std::max<std::size_t>(capacity, 1)),
      worker_([this] { run(); }) {}

FramePrefetcher::~FramePrefetcher() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  changed_.notify_all();
  worker_.join();
}

std::optional<LoadedFrame> FramePrefetcher::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !decoded_.empty() || is_finished_; });
  if (decoded_.empty()) {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::nullopt;
  }
  std::optional<LoadedFrame> frame = std::move(decoded_.front());
  decoded_.pop_front();
  lock.unlock();
  changed_.notify_all();
  return frame;
}

void FramePrefetcher::run() {
  std::exception_ptr failure;
  try {
    for (std::size_t index = range_.begin; index < range_.end; ++index) {
      {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return decoded_.size() < capacity_ || is_stopped_; });
        if (is_stopped_) break;
      }
      LoadedFrame frame = loader_(index);
      const std::lock_guard lock(mutex_);
      decoded_.push_back(std::move(frame));
      changed_.notify_all();
    }
  } catch (...) {
    failure = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  failure_ = failure;
  is_finished_ = true;
  changed_.notify_all();
}

}  // namespace lapis::sensor_replay
