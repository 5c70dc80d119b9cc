#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lapis::dds {

/// Number of participants per host that discovery looks for (rmw_fastrtps looks for 32). Fast DDS numbers the
/// participants of one process without reusing numbers, and each Participant takes two.
inline constexpr int kPeersPerHost = 64;
/// The highest domain in which each of these participants has a port: 7400 + 250 domain + 11 + 2 number is at most
/// 65535. Fast DDS ends the process when a participant has no valid port.
inline constexpr int kLargestDomain = (65535 - 7400 - 11 - 2 * (kPeersPerHost - 1)) / 250;

enum class DiscoveryRange { kSubnet, kLocalhost, kOff };

/// Addresses with the same first bits.
struct Network {
  std::uint32_t address = 0;  ///< IPv4, the first byte highest
  std::uint32_t mask = ~std::uint32_t{0};
  bool contains(std::uint32_t other) const { return (other & mask) == (address & mask); }
};

/// Who may discover this process; the settings mean the same as ROS 2 Jazzy's environment variables.
struct DiscoverySettings {
  int domain = 0;                                  ///< ROS_DOMAIN_ID
  DiscoveryRange range = DiscoveryRange::kSubnet;  ///< ROS_AUTOMATIC_DISCOVERY_RANGE
  std::vector<std::string> static_peers;           ///< ROS_STATIC_PEERS, separated by ';'
  bool has_server = false;                         ///< ROS_DISCOVERY_SERVER names one, which Fast DDS reads itself
  std::vector<Network> allowed_peers;  ///< LAPIS_ALLOWED_PEERS, separated by ';'; empty: see allowed_senders
  std::string run;                     ///< LAPIS_RUN: id of the run; empty: the process belongs to none
};

using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// The process's environment.
std::optional<std::string> process_environment(const std::string& name);

/// Reads ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and ROS_LOCALHOST_ONLY (1 forces LOCALHOST and
/// ignores the other two), LAPIS_ALLOWED_PEERS and LAPIS_RUN. An unknown range means LOCALHOST, as in rcl. Throws
/// std::runtime_error when the domain is not a number from 0 to kLargestDomain, a peer that is allowed is neither an
/// IPv4 address ("10.0.0.7") nor a network ("10.0.0.0/24"), or the run not of letters, digits, dots, dashes and
/// underscores.
DiscoverySettings discovery_from_environment(const Environment& environment = process_environment);

/// Hosts, beside the own one, whose datagrams are read. Nothing: all, which is so on SUBNET or with a discovery server,
/// which introduces hosts that nobody has named, without LAPIS_ALLOWED_PEERS. Static peers are always among them.
std::optional<std::vector<Network>> allowed_senders(const DiscoverySettings& settings);

}  // namespace lapis::dds
