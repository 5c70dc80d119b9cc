#pragma once

#include <algorithm>
#include <deque>
#include <iterator>
#include <optional>
#include <utility>

#include "common/time/time.hpp"

namespace lapis::time {

/// A source whose stamps go back by more than this has restarted; a smaller step back is disorder.
inline constexpr Duration kRestartGap{1'000'000'000};

enum class Push {
  kStored,
  kDuplicate,  ///< not stored: the stamp is in the buffer or was taken last
  kLate,       ///< not stored: later stamps have been taken
  /// Stored; the stamp is more than a second before the newest one, so the source has restarted and the older messages
  /// were dropped.
  kRestarted,
  kOverflow  ///< stored, and the oldest was dropped
};

enum class Match {
  kFound,
  kMissing,
  kWait  ///< a message that fits, or fits better, may still come
};

/// Recent messages of one stream in the order of their stamps, so that streams can be joined by stamp. Joining depends
/// on stamps only, never on the order of arrival between streams.
template <class Message>
class StampBuffer {
 public:
  explicit StampBuffer(std::size_t capacity = 8) : capacity_(capacity) {}

  Push push(Time stamp, Message message) {
    Push result = Push::kStored;
    if (is_before_restart(stamp)) {
      entries_.clear();
      taken_.reset();
      is_restart_expected_ = false;
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

  /// Forgets all messages and stamps, because the clock of the source was set.
  void begin_anew() {
    entries_.clear();
    newest_.reset();
    taken_.reset();
    is_restart_expected_ = false;
  }

  bool empty() const { return entries_.empty(); }
  std::size_t size() const { return entries_.size(); }
  bool is_full() const { return entries_.size() >= capacity_; }
  /// Oldest message; the buffer must not be empty.
  const std::pair<Time, Message>& front() const { return entries_.front(); }
  std::pair<Time, Message>& front() { return entries_.front(); }
  /// Stamp of the second oldest message.
  std::optional<Time> second() const {
    return entries_.size() < 2 ? std::nullopt : std::optional<Time>(entries_[1].first);
  }
  /// Newest stamp that was stored since the source began or has restarted.
  std::optional<Time> newest() const { return newest_; }
  /// Forgets everything up to and including `stamp`; returns the number of messages.
  std::size_t drop_until(Time stamp) {
    const std::size_t before = entries_.size();
    while (!entries_.empty() && entries_.front().first <= stamp) entries_.pop_front();
    // A stream that has restarted alone has not reached `stamp` yet, so its next messages are not late.
    const Time reached = std::min(stamp, newest_.value_or(stamp));
    taken_ = std::max(taken_.value_or(reached), reached);
    return before - entries_.size();
  }

  /// Another stream of the same source has restarted at `stamp`. If this stream has not restarted yet, match() waits
  /// for it: later messages from before the restart do not mean that no better match will come.
  void expect_restart(Time stamp) { is_restart_expected_ = !newest_ || is_before_restart(stamp); }

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
    const bool is_awaited = is_restart_expected_ && is_before_restart(stamp);
    const bool is_settled = is_exact || is_complete || (newest_ && *newest_ >= stamp && !is_awaited);
    if (!is_settled) return Match::kWait;
    return found != nullptr ? Match::kFound : Match::kMissing;
  }

 private:
  /// True when the stream is so far ahead of `stamp` that its source must have restarted since.
  bool is_before_restart(Time stamp) const { return newest_ && *newest_ - stamp > kRestartGap; }

  std::size_t capacity_;
  std::deque<std::pair<Time, Message>> entries_;
  std::optional<Time> newest_;
  std::optional<Time> taken_;
  bool is_restart_expected_ = false;
};

}  // namespace lapis::time
