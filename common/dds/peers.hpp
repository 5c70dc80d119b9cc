#pragma once

#include <array>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/gid.hpp"

namespace lapis::dds {

/// How another participant of the domain is related to this process.
enum class Kinship {
  kOwnRun,
  kNoRun,    ///< it names no run, or has not been found yet, or this process names none
  kOtherRun  ///< it belongs to another run, whose data must not mix with that of this one
};

/// The participants that discovery has found, by the run that each one names in its user data ("run=ID;").
class Peers {
 public:
  /// `run`: id of this process's run; empty: it belongs to none.
  explicit Peers(std::string run) : run_(std::move(run)) {}

  /// Notes a participant that has been found; may be called from any thread.
  void add(const Gid& participant, const std::string& user_data);

  /// The kinship of the participant to which an endpoint belongs; kNoRun for an unknown one.
  Kinship kinship(const Gid& endpoint) const;
  const std::string& run() const { return run_; }
  /// The run of the participant to which an endpoint belongs; empty: none, or it has not been found yet.
  std::string run_of(const Gid& endpoint) const;
  /// Ids of the other runs that have been found since the last call.
  std::vector<std::string> take_other_runs();

 private:
  static constexpr std::size_t kMostParticipants = 10'000;  // that name a run; further ones count as of no run
  static constexpr std::size_t kMostRuns = 100;             // that are named

  using Prefix = std::array<std::uint8_t, kGidPrefixBytes>;
  static Prefix prefix_of(const Gid& gid);

  const std::string run_;
  mutable std::mutex mutex_;
  /// Runs by participant. Participants that have left stay, because their last samples may still be taken.
  std::map<Prefix, std::string> runs_;
  std::vector<std::string> other_runs_, new_runs_;
};

}  // namespace lapis::dds
