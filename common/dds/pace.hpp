#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>

#include "common/dds/link.hpp"

namespace lapis::dds {

/// How far the writers of large samples of a participant are behind what they were given. Fast DDS sends in the order
/// of writing and lets new samples replace old ones of which half has been sent, so that on a slow link nearly none
/// arrives whole. So who publishes frames asks before each one, and leaves out the whole frame, its small messages too,
/// when it would come too late.
///
/// Fast DDS counts a message once, though it sends a copy to each process that reads: with readers in n processes on
/// other hosts, the network carries n times the pace.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Pace(const LargeSettings& settings)
      : bytes_per_s_(1e3 * settings.bytes_per_period / settings.pace_period_ms) {}

  bool is_limited() const { return bytes_per_s_ > 0.0; }
  /// Whether what is written now would be sent soon. Always true without a limit. From any thread.
  bool has_room(Clock::time_point now) const;
  /// Notes a sample that is written. From any thread.
  void add(std::size_t bytes, Clock::time_point now);

 private:
  static constexpr double kSentPerPayload = 1.1;  // headers and repairs
  static constexpr auto kLongestBacklog = std::chrono::milliseconds(150);

  const double bytes_per_s_;
  mutable std::mutex mutex_;
  Clock::time_point free_ = Clock::time_point::min();  // when all that has been written will have been sent
};

}  // namespace lapis::dds
