#include "command_line/core/rate_meter.hpp"

#include <algorithm>
#include <cmath>

namespace lapis::command_line {
namespace {

constexpr double kSecondsPerNs = 1e-9;

}  // namespace

void RateMeter::add(std::int64_t arrival_ns, std::size_t bytes) {
  ++messages_;
  arrivals_.push_back({arrival_ns, bytes});
  if (arrivals_.size() > window_) arrivals_.pop_front();
}

RateMeter::Rate RateMeter::rate() const {
  Rate rate;
  rate.messages = messages_;
  rate.in_window = arrivals_.size();
  if (arrivals_.empty()) return rate;
  rate.smallest_bytes = arrivals_.front().bytes;
  std::size_t sum = 0;
  for (const Arrival& arrival : arrivals_) {
    sum += arrival.bytes;
    rate.smallest_bytes = std::min(rate.smallest_bytes, arrival.bytes);
    rate.largest_bytes = std::max(rate.largest_bytes, arrival.bytes);
  }
  rate.mean_bytes = static_cast<double>(sum) / static_cast<double>(arrivals_.size());
  add_gaps(rate);
  rate.bytes_per_s = rate.mean_bytes * rate.rate_hz;
  return rate;
}

void RateMeter::add_gaps(Rate& rate) const {
  const double span_s = kSecondsPerNs * static_cast<double>(arrivals_.back().at_ns - arrivals_.front().at_ns);
  if (arrivals_.size() < 2 || span_s <= 0.0) return;
  const auto gaps = static_cast<double>(arrivals_.size() - 1);
  const double mean_s = span_s / gaps;
  rate.rate_hz = 1.0 / mean_s;
  rate.shortest_gap_s = span_s;
  double squares = 0.0;
  for (std::size_t i = 1; i < arrivals_.size(); ++i) {
    const double gap_s = kSecondsPerNs * static_cast<double>(arrivals_[i].at_ns - arrivals_[i - 1].at_ns);
    rate.shortest_gap_s = std::min(rate.shortest_gap_s, gap_s);
    rate.longest_gap_s = std::max(rate.longest_gap_s, gap_s);
    squares += (gap_s - mean_s) * (gap_s - mean_s);
  }
  rate.deviation_s = std::sqrt(squares / gaps);
}

}  // namespace lapis::command_line
