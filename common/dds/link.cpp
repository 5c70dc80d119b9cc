#include "common/dds/link.hpp"

namespace lapis::dds {

bool stays_on_host(const DiscoverySettings& discovery) {
  // Static peers may be on other hosts, which only the other interfaces reach.
  return discovery.range == DiscoveryRange::kLocalhost && discovery.static_peers.empty();
}

LinkSettings link_of(const DiscoverySettings& discovery) {
  return stays_on_host(discovery) ? kLoopbackLink : kNetworkLink;
}

}  // namespace lapis::dds
