#include "common/logging/line_queue.hpp"

#include <utility>

namespace lapis::logging {
namespace {

std::string text_of(const char* text) { return text == nullptr ? "" : text; }

}  // namespace

std::deque<Line> LineQueue::take() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return is_closed_ || !lines_.empty(); });
  return std::exchange(lines_, {});
}

void LineQueue::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  changed_.notify_all();
}

void LineQueue::sink_it_(const spdlog::details::log_msg& message) {
  if (is_closed_) return;
  if (lines_.size() == kMost) lines_.pop_front();
  lines_.push_back({message.time, message.level, std::string(message.payload.data(), message.payload.size()),
                    text_of(message.source.filename), text_of(message.source.funcname),
                    static_cast<std::uint32_t>(message.source.line)});
  changed_.notify_all();
}

}  // namespace lapis::logging
