#pragma once

#include <algorithm>
#include <deque>
#include <iterator>
#include <optional>
#include <utility>

#include "common/time/time.hpp"

namespace lapis::time {

/// A source whose stamps go back by more than this began anew; less is disorder.
inline constexpr Duration kRestartGap{1'000'000'000};

enum class Push {
  kStored,
  kDuplicate,  ///< not stored: the stamp is there or was taken last
  kLate,       ///< not stored: later stamps have been taken
  kRestarted,  ///< stored; the stamp lies more than a second in the past, so the source began anew and the rest is gone
  kOverflow    ///< stored, and the oldest was dropped
};

enum class Match {
  kFound,
  kMissing,
  kWait  ///< one that fits (better) may still come
};

/// Recent messages of one stream in the order of their stamps, so that streams can be joined by stamp. Joining depends
/// on stamps only, never on the order of arrival between streams.
template <class Message>
class StampBuffer {
 public:
  explicit StampBuffer(std::size_t capacity = 8) : capacity_(capacity) {}

  Push push(Time stamp, Message message) {
    Push result = Push::kStored;
    if (newest_ && *newest_ - stamp > kRestartGap) {
      entries_.clear();
      taken_.reset();
      result = Push::kRestarted;
    }
    if (taken_ && stamp <= *taken_) return stamp == *taken_ ? Push::kDuplicate : Push::kLate;
    auto at = entries_.end();
    while (at != entries_.begin() && std::prev(at)->first > stamp) --at;
    if (at != entries_.begin() && std::prev(at)->first == stamp) return Push::kDuplicate;
    entries_.emplace(at, stamp, std::move(message));
    newest_ = result == Push::kRestarted ? stamp : std::max(newest_.value_or(stamp), stamp);
    if (entries_.size() > capacity_) {
      entries_.pop_front();
      if (result == Push::kStored) result = Push::kOverflow;
    }
    return result;
  }

  bool empty() const { return entries_.empty(); }
  bool is_full() const { return entries_.size() >= capacity_; }
  /// Oldest message; the buffer must not be empty.
  std::pair<Time, Message>& front() { return entries_.front(); }
  /// Forgets everything up to and including `stamp`.
  void drop_until(Time stamp) {
    while (!entries_.empty() && entries_.front().first <= stamp) entries_.pop_front();
    taken_ = std::max(taken_.value_or(stamp), stamp);
  }

  /// Looks for the message nearest to `stamp` within `tolerance`; `is_complete` says that nothing more will come.
  Match match(Time stamp, Duration tolerance, bool is_complete, Message*& found) {
    found = nullptr;
    std::optional<Duration> best;
    for (auto& [time, message] : entries_) {
      const Duration distance = abs(time - stamp);
      if (distance <= tolerance && (!best || distance < *best)) {
        best = distance;
        found = &message;
      }
    }
    const bool is_exact = best && best->nanoseconds == 0;
    const bool is_settled = is_exact || is_complete || (newest_ && *newest_ >= stamp);
    if (!is_settled) return Match::kWait;
    return found != nullptr ? Match::kFound : Match::kMissing;
  }

 private:
  std::size_t capacity_;
  std::deque<std::pair<Time, Message>> entries_;
  std::optional<Time> newest_;
  std::optional<Time> taken_;
};

}  // namespace lapis::time
