#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>

#include "common/dds/link.hpp"

namespace lapis::dds {

/// How far the writers of large samples of a participant are behind what they were given. Fast DDS sends in the order
/// of writing and lets new samples replace old ones of which half has been sent, so that on a slow link nearly none
/// arrives whole. So what would come too late is not written at all.
class Pace {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Pace(const LargeSettings& settings)
      : bytes_per_s_(1e3 * settings.bytes_per_period / settings.pace_period_ms) {}

  /// Whether a sample that a newer one will replace would be sent soon. Always true when nothing is paced.
  bool has_room(Clock::time_point now);
  /// In lock-step the next frame waits until this one has been worked on, so all of it is sent. From any thread.
  void leave_nothing_out() { leaves_nothing_out_ = true; }
  /// Notes a sample that is written.
  void add(std::size_t bytes, Clock::time_point now);

 private:
  static constexpr double kSentPerPayload = 1.2;  // headers and repairs, up to 1 % of loss
  static constexpr auto kLongestBacklog = std::chrono::milliseconds(150);

  const double bytes_per_s_;
  std::atomic<bool> leaves_nothing_out_{false};
  std::mutex mutex_;
  Clock::time_point free_;  // when all that has been written will have been sent
};

}  // namespace lapis::dds
