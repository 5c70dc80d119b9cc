#include "common/dds/pace.hpp"

#include <algorithm>

namespace lapis::dds {

bool Pace::has_room(Clock::time_point now) const {
  const std::lock_guard lock(mutex_);
  return free_ <= now + kLongestBacklog;
}

void Pace::add(std::size_t bytes, Clock::time_point now) {
  if (!is_limited()) return;
  const std::chrono::duration<double> needed(kSentPerPayload * static_cast<double>(bytes) / bytes_per_s_);
  const std::lock_guard lock(mutex_);
  free_ = std::max(free_, now) + std::chrono::duration_cast<Clock::duration>(needed);
}

}  // namespace lapis::dds
