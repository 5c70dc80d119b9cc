#include "common/time/stamp_tolerance.hpp"

#include <algorithm>
#include <vector>

namespace lapis::time {
namespace {

constexpr std::size_t kPeriods = 9;  // their lower quartile is the stream's period, even where messages are missing

Duration tolerance_of(Duration period) {
  return std::min(Duration{period.nanoseconds / 10 * 6}, StampTolerance::kLargest);
}

}  // namespace

std::optional<Duration> StampTolerance::of(Time oldest, std::optional<Time> next) const {
  if (fixed_.nanoseconds > 0) return fixed_;
  if (!periods_.empty()) {
    std::vector<Duration> sorted(periods_.begin(), periods_.end());
    std::sort(sorted.begin(), sorted.end());
    return tolerance_of(sorted[(sorted.size() - 1) / 4]);
  }
  return next ? std::optional(tolerance_of(*next - oldest)) : std::nullopt;
}

void StampTolerance::note(Time stamp) {
  if (newest_ && stamp < *newest_) begin_anew();
  if (newest_) periods_.push_back(stamp - *newest_);
  if (periods_.size() > kPeriods) periods_.pop_front();
  newest_ = stamp;
}

void StampTolerance::begin_anew() {
  periods_.clear();
  newest_.reset();
}

}  // namespace lapis::time
