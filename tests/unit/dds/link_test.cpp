#include "common/dds/link.hpp"

#include <gtest/gtest.h>

namespace lapis::dds {
namespace {

DiscoverySettings in_range(DiscoveryRange range, std::vector<std::string> static_peers = {}) {
  DiscoverySettings settings;
  settings.range = range;
  settings.static_peers = std::move(static_peers);
  return settings;
}

TEST(Link, OnlyLocalhostWithoutPeersAndServerStaysOnTheHost) {
  DiscoverySettings settings = in_range(DiscoveryRange::kLocalhost);
  EXPECT_TRUE(stays_on_host(settings));
  settings.has_server = true;
  EXPECT_FALSE(stays_on_host(settings));
  EXPECT_FALSE(stays_on_host(in_range(DiscoveryRange::kLocalhost, {"10.0.0.7"})));
  EXPECT_FALSE(stays_on_host(in_range(DiscoveryRange::kSubnet)));
}

TEST(Link, MessagesAreSmallOnANetworkUnlessSharedMemoryIsAskedFor) {
  EXPECT_EQ(link_of(in_range(DiscoveryRange::kLocalhost)).message_bytes, kLoopbackLink.message_bytes);
  EXPECT_EQ(link_of(in_range(DiscoveryRange::kSubnet)).message_bytes, kNetworkLink.message_bytes);
  const LinkSettings shared = link_of(in_range(DiscoveryRange::kSubnet), Transport::kSharedMemory);
  EXPECT_EQ(shared.message_bytes, kLoopbackLink.message_bytes);
  EXPECT_EQ(shared.large.bytes_per_period, 0) << "no pace";
}

}  // namespace
}  // namespace lapis::dds
