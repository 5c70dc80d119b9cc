#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace lapis::logging {

/// Lets a repeated message through once per period and counts the suppressed ones. Keys may quote what others send:
/// from the kMostKeys-th on all new ones count as one. For use by one thread only.
class RateLimit {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMostKeys = 200;

  explicit RateLimit(Clock::duration period = std::chrono::seconds(5)) : period_(period) {}

  /// Returns nothing when the message with this key was let through less than a period ago, otherwise the number of
  /// messages that were suppressed since then.
  std::optional<std::uint64_t> pass(const std::string& key, Clock::time_point now = Clock::now()) {
    const bool has_place = seen_.contains(key) || seen_.size() + 1 < kMostKeys;
    auto [it, is_new] = seen_.try_emplace(has_place ? key : "", Seen{now, 0});
    if (!is_new && now - it->second.last < period_) {
      ++it->second.held_back;
      return std::nullopt;
    }
    const std::uint64_t held_back = it->second.held_back;
    it->second = {now, 0};
    return held_back;
  }

 private:
  struct Seen {
    Clock::time_point last;
    std::uint64_t held_back = 0;
  };
  Clock::duration period_;
  std::map<std::string, Seen> seen_;
};

}  // namespace lapis::logging
