#include "common/dds/stream_owner.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace lapis::dds {

StreamOwner::Peer& StreamOwner::note(const Gid& writer) {
  const auto [it, is_new] = writers_.try_emplace(writer);
  if (is_new) it->second.ordinal = ++seen_;
  return it->second;
}

/// Writers of the own run keep their place in the order: one whose connection was lost comes back as the older one.
void StreamOwner::unmatch(const Gid& writer) {
  const auto it = writers_.find(writer);
  if (it == writers_.end()) return;
  it->second.is_matched = false;
  if (peers_.kinship(writer) != Kinship::kOwnRun) writers_.erase(it);
}

void StreamOwner::unmatch_all() {
  std::vector<Gid> known;
  for (const auto& [writer, peer] : writers_) known.push_back(writer);
  for (const Gid& writer : known) unmatch(writer);
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

bool StreamOwner::admits(const std::optional<Gid>& signer) {
  if (!signer) {
    if (!is_owner_matched()) return true;
    ++refused_unsigned_;
    return false;
  }
  switch (peers_.kinship(*signer)) {
    case Kinship::kOtherRun: return false;
    case Kinship::kNoRun: return true;  // discovery has not told its run yet, but it has one
    case Kinship::kOwnRun: break;
  }
  const std::uint64_t ordinal = note(*signer).ordinal;
  if (owner_ && ordinal < note(*owner_).ordinal) return false;
  owner_ = *signer;
  return true;
}

bool StreamOwner::accepts(const Gid& writer, Clock::time_point now) {
  const Kinship kinship = peers_.kinship(writer);
  if (kinship != Kinship::kNoRun || peers_.run().empty()) return kinship != Kinship::kOtherRun;
  const bool has_other = stranger_ && *stranger_ != writer && is_matched(*stranger_) && now - heard_ <= kSilence;
  if (has_other) return false;
  stranger_ = writer;
  heard_ = now;
  return true;
}

bool StreamOwner::refuses(const Gid& writer) const {
  switch (peers_.kinship(writer)) {
    case Kinship::kOtherRun: return true;
    case Kinship::kNoRun: return is_owner_matched();
    case Kinship::kOwnRun: break;
  }
  const auto it = writers_.find(writer);
  return owner_ && it != writers_.end() && it->second.ordinal < writers_.at(*owner_).ordinal;
}

/// Nobody knows whose samples those are that are not signed. An older writer of the own run is never heard again.
bool StreamOwner::was_interrupted(const Gid& writer) {
  const auto it = writers_.find(writer);
  if (it == writers_.end() || peers_.kinship(writer) != Kinship::kNoRun) return false;
  return std::exchange(it->second.refused_unsigned, refused_unsigned_) != refused_unsigned_;
}

}  // namespace lapis::dds
