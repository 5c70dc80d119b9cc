#include "common/time/stamp_judge.hpp"

#include <cstdint>

#include "common/time/stamp_buffer.hpp"

namespace lapis::time {
namespace {

constexpr std::int64_t kFastestPlayback = 10;  // of a recording, which may have gaps

std::int64_t nanoseconds_between(Arrival from, Arrival to) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(to - from).count();
}

}  // namespace

bool follows(const Stamped& before, const Stamped& now) {
  const Duration ahead = now.stamp - before.stamp;
  const std::int64_t elapsed_ns = nanoseconds_between(before.arrival, now.arrival);
  return ahead >= -kRestartGap && ahead.nanoseconds <= kRestartGap.nanoseconds + kFastestPlayback * elapsed_ns;
}

StampJudge::Verdict StampJudge::judge(Time stamp, Arrival arrival) {
  const Stamped message{stamp, arrival};
  if (newest_ && !follows(*newest_, message)) {
    if (!doubtful_ || !follows(*doubtful_, message) || stamp == doubtful_->stamp) {
      doubtful_ = message;
      return Verdict::kDoubtful;
    }
    const Time expected = newest_->stamp + Duration{nanoseconds_between(newest_->arrival, arrival)};
    step_ = stamp - expected;
    newest_ = message;
    doubtful_.reset();
    return Verdict::kStepped;
  }
  const bool has_stray = doubtful_.has_value();
  doubtful_.reset();
  if (!newest_ || stamp > newest_->stamp) newest_ = message;
  return has_stray ? Verdict::kStray : Verdict::kFits;
}

}  // namespace lapis::time
