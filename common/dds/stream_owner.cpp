#include "common/dds/stream_owner.hpp"

#include <algorithm>

namespace lapis::dds {

/// The order of writers of the own run is kept, because samples of one that has left may still be taken.
void StreamOwner::unmatch(const Gid& writer) {
  const auto it = writers_.find(writer);
  if (it == writers_.end()) return;
  it->second.is_matched = false;
  if (peers_.kinship(writer) != Kinship::kOwnRun) writers_.erase(it);
}

std::size_t StreamOwner::matched() const {
  return static_cast<std::size_t>(std::count_if(writers_.begin(), writers_.end(), [this](const auto& entry) {
    return entry.second.is_matched && peers_.kinship(entry.first) != Kinship::kOtherRun;
  }));
}

bool StreamOwner::is_matched(const Gid& writer) const {
  const auto it = writers_.find(writer);
  return it != writers_.end() && it->second.is_matched;
}

bool StreamOwner::is_participant_matched(const Gid& participant) const {
  return std::any_of(writers_.begin(), writers_.end(), [&](const auto& entry) {
    return entry.second.is_matched &&
           std::equal(participant.begin(), participant.begin() + kGidPrefixBytes, entry.first.begin());
  });
}

bool StreamOwner::accepts(const Gid& writer, Clock::time_point now) {
  const Kinship kinship = peers_.kinship(writer);
  if (kinship == Kinship::kOtherRun) return false;
  if (!has_one_writer_ || peers_.run().empty()) return true;
  if (!(kinship == Kinship::kOwnRun ? succeeds(writer) : substitutes(writer, now))) return false;
  owner_ = writer;
  heard_ = now;
  return true;
}

/// Whether a writer of the own run may have the stream.
bool StreamOwner::succeeds(const Gid& writer) const {
  const bool has_kin = owner_ && peers_.kinship(*owner_) == Kinship::kOwnRun;
  return !has_kin || ordinal(writer) >= ordinal(*owner_);
}

/// Whether a writer without a run may have the stream.
bool StreamOwner::substitutes(const Gid& writer, Clock::time_point now) const {
  if (!owner_ || writer == *owner_ || !is_matched(*owner_)) return true;
  return peers_.kinship(*owner_) != Kinship::kOwnRun && now - heard_ > kSilence;
}

std::uint64_t StreamOwner::ordinal(const Gid& writer) const {
  const auto it = writers_.find(writer);
  return it == writers_.end() ? 0 : it->second.ordinal;
}

}  // namespace lapis::dds
