#include "common/dds/link.hpp"

namespace lapis::dds {

bool stays_on_host(const DiscoverySettings& discovery) {
  // Static peers, and those whom a server introduces, may be on other hosts, which only the other interfaces reach.
  return discovery.range == DiscoveryRange::kLocalhost && discovery.static_peers.empty() && !discovery.has_server;
}

LinkSettings link_of(const DiscoverySettings& discovery, Transport transport) {
  return stays_on_host(discovery) || transport == Transport::kSharedMemory ? kLoopbackLink : kNetworkLink;
}

}  // namespace lapis::dds
