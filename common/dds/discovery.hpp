#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace lapis::dds {

/// Participants of a host that others look for. rmw_fastrtps looks for 32. Fast DDS numbers those of one process
/// without reusing numbers, and each of ours takes two.
inline constexpr int kPeersPerHost = 64;
/// The last domain in which each of them has a port: 7400 + 250 domain + 11 + 2 number is 65535 at most. Where one has
/// none, Fast DDS ends the process.
inline constexpr int kLargestDomain = (65535 - 7400 - 11 - 2 * (kPeersPerHost - 1)) / 250;

enum class DiscoveryRange { kSubnet, kLocalhost, kOff };

/// Who may find us; the meaning of ROS 2 Jazzy's environment variables.
struct DiscoverySettings {
  int domain = 0;                                  ///< ROS_DOMAIN_ID
  DiscoveryRange range = DiscoveryRange::kSubnet;  ///< ROS_AUTOMATIC_DISCOVERY_RANGE
  std::vector<std::string> static_peers;           ///< ROS_STATIC_PEERS, separated by ';'
};

using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// The process's environment.
std::optional<std::string> process_environment(const std::string& name);

/// Reads ROS_DOMAIN_ID, ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS and ROS_LOCALHOST_ONLY (1 forces LOCALHOST and
/// ignores the other two). An unknown range means LOCALHOST, as in rcl. Throws std::runtime_error when the domain is
/// not a number from 0 to kLargestDomain. ROS_DISCOVERY_SERVER is read by Fast DDS itself.
DiscoverySettings discovery_from_environment(const Environment& environment = process_environment);

}  // namespace lapis::dds
