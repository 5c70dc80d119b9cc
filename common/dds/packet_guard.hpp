#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "common/dds/compat.hpp"
#include "common/dds/discovery.hpp"
#include "common/dds/packet_check.hpp"

namespace lapis::dds {

/// Knows how far writers have come. A new one may have written for weeks; after that it gets no further than it can
/// have written since.
class WriterProgress : public SequenceJudge {
 public:
  using Clock = std::chrono::steady_clock;
  /// 50 days at 1 kHz. A reader that joins counts up to there, which takes it seven minutes.
  static constexpr std::int64_t kLargestFirst = std::int64_t{1} << 32;
  static constexpr std::int64_t kLongestJump = 1 << 20;   ///< samples
  static constexpr std::int64_t kHighestRateHz = 10'000;  ///< samples per second, on top of a jump

  bool believes(const Gid& writer, std::int64_t number) override { return believes(writer, number, Clock::now()); }
  bool believes(const Gid& writer, std::int64_t number, Clock::time_point now);

 private:
  static constexpr std::size_t kMostWriters = 10'000;  // then all of them are new again

  struct Progress {
    std::int64_t number = 0;
    Clock::time_point heard;
  };

  std::mutex mutex_;
  std::map<Gid, Progress> writers_;
};

/// Keeps datagrams away from Fast DDS that come from foreign hosts, where the settings say who may send, or that it
/// cannot bear (find_fault). Datagrams of the own host always come from an allowed sender; the kernel sees to it that
/// nobody else uses its addresses.
class PacketGuard : public compat::PacketInspector {
 public:
  explicit PacketGuard(const DiscoverySettings& settings) : senders_(allowed_senders(settings)) {}

  bool admits(std::span<const std::uint8_t> message, const compat::rtps::Locator_t& sender, bool is_local) override;

  /// Datagrams that were dropped for a reason.
  struct Dropped {
    std::uint64_t count = 0;
    std::string newest_sender;  ///< IPv4 address
  };
  Dropped dropped(PacketFault fault) const;

 private:
  struct Counter {
    std::atomic<std::uint64_t> count{0};
    std::atomic<std::uint32_t> newest_sender{0};
  };

  const std::optional<std::vector<Network>> senders_;  // nothing: all
  WriterProgress progress_;
  std::array<Counter, kPacketFaults> dropped_;
};

}  // namespace lapis::dds
