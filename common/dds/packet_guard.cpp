#include "common/dds/packet_guard.hpp"

#include <algorithm>

namespace lapis::dds {

bool WriterProgress::believes(const Gid& writer, std::int64_t number, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  const auto it = writers_.find(writer);
  if (it == writers_.end()) {
    if (number > kLargestFirst) return false;
    if (writers_.size() >= kMostWriters) writers_.clear();
    writers_.emplace(writer, Progress{number, now});
    return true;
  }
  Progress& known = it->second;
  const auto silence_s = std::chrono::ceil<std::chrono::seconds>(now - known.heard).count();
  if (number - known.number > kLongestJump + silence_s * kHighestRateHz) return false;
  if (number >= known.number) known = {number, now};
  return true;
}

bool PacketGuard::admits(std::span<const std::uint8_t> message, const compat::rtps::Locator_t& sender, bool is_local) {
  const std::uint32_t address = compat::ipv4_of(sender);
  const auto has_sender = [&](const Network& network) { return network.contains(address); };
  const bool is_allowed = is_local || !senders_ || std::any_of(senders_->begin(), senders_->end(), has_sender);
  const auto fault = is_allowed ? find_fault(message, progress_) : PacketFault::kSender;
  if (!fault) return true;
  Counter& counter = dropped_[static_cast<std::size_t>(*fault)];
  counter.newest_sender = address;
  ++counter.count;
  return false;
}

PacketGuard::Dropped PacketGuard::dropped(PacketFault fault) const {
  const Counter& counter = dropped_[static_cast<std::size_t>(fault)];
  const std::uint32_t address = counter.newest_sender;
  std::string text;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    text += (text.empty() ? "" : ".") + std::to_string((address >> shift) & 255U);
  }
  return {counter.count, text};
}

}  // namespace lapis::dds
