#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "common/dds/peers.hpp"

namespace lapis::dds {

/// Decides whose samples a reader accepts. Data of another run is refused. A stream with one writer belongs to the
/// newest writer of this process's own run, so that a restarted process takes the place of the one before it; a writer
/// without a run is accepted while no writer of the own run is there that has spoken. Among writers without a run, the
/// first one keeps the stream until it has left or has been silent for kSilence. A process without a run accepts all.
/// The source is docs/decisions/0053-one-writer-per-stream.md.
class StreamOwner {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kSilence{1};

  /// `peers` must outlive this object. `has_one_writer`: whether the topic is to have one writer only.
  StreamOwner(const Peers& peers, bool has_one_writer) : peers_(peers), has_one_writer_(has_one_writer) {}

  void match(const Gid& writer) { writers_[writer] = {++matches_, true}; }
  void unmatch(const Gid& writer);

  /// Number of writers that are matched and not of another run.
  std::size_t matched() const;
  bool is_matched(const Gid& writer) const;
  /// True when any writer of a participant is matched.
  bool is_participant_matched(const Gid& participant) const;

  /// Whether a sample of that writer, taken at `now`, is accepted.
  bool accepts(const Gid& writer, Clock::time_point now);

 private:
  struct Writer {
    std::uint64_t ordinal = 0;  // in the order of the matches
    bool is_matched = false;
  };

  bool succeeds(const Gid& writer) const;
  bool substitutes(const Gid& writer, Clock::time_point now) const;
  std::uint64_t ordinal(const Gid& writer) const;

  const Peers& peers_;
  bool has_one_writer_;
  std::map<Gid, Writer> writers_;
  std::uint64_t matches_ = 0;
  std::optional<Gid> owner_;
  Clock::time_point heard_;  // the owner's newest sample
};

}  // namespace lapis::dds
