#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "common/dds/compat.hpp"
#include "common/dds/discovery.hpp"
#include "common/dds/packet_check.hpp"

namespace lapis::dds {

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
  std::array<Counter, kPacketFaults> dropped_;
};

}  // namespace lapis::dds
