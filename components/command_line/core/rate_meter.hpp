#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace lapis::command_line {

/// Rate and size of the messages of a topic, over the newest ones.
class RateMeter {
 public:
  /// @param window number of messages that are looked at
  explicit RateMeter(std::size_t window) : window_(window) {}

  void add(std::int64_t arrival_ns, std::size_t bytes);

  struct Rate {
    std::size_t messages = 0;     ///< since the start
    std::size_t in_window = 0;    ///< of which the other figures are
    double rate_hz = 0.0;         ///< 0 with fewer than two messages, like the gaps
    double shortest_gap_s = 0.0;  ///< between a message and the next
    double longest_gap_s = 0.0;
    double deviation_s = 0.0;  ///< standard deviation of the gaps
    double bytes_per_s = 0.0;
    double mean_bytes = 0.0;
    std::size_t smallest_bytes = 0;
    std::size_t largest_bytes = 0;
  };
  Rate rate() const;

 private:
  struct Arrival {
    std::int64_t at_ns;
    std::size_t bytes;
  };
  void add_gaps(Rate& rate) const;

  std::size_t window_;
  std::size_t messages_ = 0;
  std::deque<Arrival> arrivals_;
};

}  // namespace lapis::command_line
