#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include "common/dds/peers.hpp"

namespace lapis::dds {

/// Decides whose samples of a stream with one writer are accepted, by a process that belongs to a run. Those of another
/// run are refused. The stream belongs to the newest writer of the own run, so that a restarted process takes the place
/// of the one before it. A writer without a run is accepted while no writer of the own run has the stream; among
/// several of these, the first one keeps it until it has left or has been silent for kSilence. The reasons are in
/// docs/decisions/0054-one-writer-per-stream.md. The caller sees to it that threads take turns.
class StreamOwner {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds kSilence{1};

  /// `peers` must outlive this object.
  explicit StreamOwner(const Peers& peers) : peers_(peers) {}

  void match(const Gid& writer) { note(writer).is_matched = true; }
  void unmatch(const Gid& writer);
  void unmatch_all();
  /// Number of writers that are matched and not of another run.
  std::size_t matched() const;
  bool is_matched(const Gid& writer) const;
  /// True when any writer of a participant is matched.
  bool is_participant_matched(const Gid& participant) const;

  /// Whether a sample is admitted when it arrives, before DDS stores it.
  /// @param signer writer that signed it, as processes of a run do; nothing when it is not signed
  bool admits(const std::optional<Gid>& signer);
  /// Whether an admitted sample is accepted when it is taken: settles which of several writers without a run has the
  /// stream.
  bool accepts(const Gid& writer, Clock::time_point now);
  /// Whether samples that a writer sends now would be refused when they arrive, so that nobody needs to wait for them.
  bool refuses(const Gid& writer) const;
  /// Whether samples of a writer may have been refused when they arrived, since this was asked last: what is missing
  /// among its numbers is no loss then.
  bool was_interrupted(const Gid& writer);

 private:
  struct Peer {
    std::uint64_t ordinal = 0;  // in the order in which they were first seen
    bool is_matched = false;
    std::uint64_t refused_unsigned = 0;  // when was_interrupted() was asked last
  };

  Peer& note(const Gid& writer);
  bool is_owner_matched() const { return owner_ && is_matched(*owner_); }

  const Peers& peers_;
  std::map<Gid, Peer> writers_;
  std::uint64_t seen_ = 0;
  std::optional<Gid> owner_;     // of the own run
  std::optional<Gid> stranger_;  // without a run
  Clock::time_point heard_;      // the stranger's newest sample
  std::uint64_t refused_unsigned_ = 0;
};

}  // namespace lapis::dds
