#include "recorder/core/snapshot_buffer.hpp"

#include <algorithm>
#include <utility>

namespace lapis::recorder {

void SnapshotBuffer::add(bags::Message message, bool is_latched) {
  if (is_latched_.size() <= message.channel) is_latched_.resize(message.channel + 1);
  is_latched_[message.channel] = is_latched;
  bytes_ += message.data.size();
  const std::int64_t newest_ns = message.log_time_ns;
  messages_.push_back(std::move(message));
  while (!messages_.empty() && (newest_ns - messages_.front().log_time_ns > span_ns_ || bytes_ > most_bytes_)) {
    drop_oldest();
  }
}

void SnapshotBuffer::drop_oldest() {
  bags::Message message = std::move(messages_.front());
  messages_.pop_front();
  bytes_ -= message.data.size();
  if (!is_latched_[message.channel]) return;
  std::erase_if(latched_, [&](const bags::Message& other) { return other.channel == message.channel; });
  latched_.push_back(std::move(message));
}

std::vector<bags::Message> SnapshotBuffer::take() {
  std::vector<bags::Message> all;
  const std::int64_t oldest_ns = messages_.empty() ? 0 : messages_.front().log_time_ns;
  for (const bags::Message& message : latched_) {
    all.push_back(message);
    if (!messages_.empty()) all.back().log_time_ns = std::max(message.log_time_ns, oldest_ns);
  }
  const auto begin = static_cast<std::ptrdiff_t>(all.size());
  while (!messages_.empty()) {
    all.push_back(messages_.front());
    drop_oldest();
  }
  std::stable_sort(all.begin() + begin, all.end(),
                   [](const bags::Message& a, const bags::Message& b) { return a.log_time_ns < b.log_time_ns; });
  return all;
}

}  // namespace lapis::recorder
