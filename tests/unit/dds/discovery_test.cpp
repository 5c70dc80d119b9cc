#include "common/dds/discovery.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

namespace lapis::dds {
namespace {

using Variables = std::map<std::string, std::string>;

DiscoverySettings settings(const Variables& variables) {
  return discovery_from_environment([&](const std::string& name) -> std::optional<std::string> {
    const auto it = variables.find(name);
    return it == variables.end() ? std::nullopt : std::optional<std::string>(it->second);
  });
}

TEST(Discovery, DefaultsAreDomainZeroOnTheSubnet) {
  for (const Variables& variables :
       {Variables{}, Variables{{"ROS_DOMAIN_ID", ""}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", ""}}}) {
    const auto found = settings(variables);
    EXPECT_EQ(found.domain, 0);
    EXPECT_EQ(found.range, DiscoveryRange::kSubnet);
    EXPECT_TRUE(found.static_peers.empty());
  }
}

TEST(Discovery, DomainIsANumberFrom0To231) {
  EXPECT_EQ(settings({{"ROS_DOMAIN_ID", "42"}}).domain, 42);
  EXPECT_EQ(settings({{"ROS_DOMAIN_ID", "231"}}).domain, 231);
  for (const char* bad : {"232", "-1", "x", "4 ", " 4", "0x10", "1e1", "99999999999999"}) {
    EXPECT_THROW(settings({{"ROS_DOMAIN_ID", bad}}), std::runtime_error) << bad;
  }
}

TEST(Discovery, RangeWordsAreThoseOfJazzy) {
  const std::map<std::string, DiscoveryRange> words = {
      {"SUBNET", DiscoveryRange::kSubnet},       {"SYSTEM_DEFAULT", DiscoveryRange::kSubnet},
      {"LOCALHOST", DiscoveryRange::kLocalhost}, {"OFF", DiscoveryRange::kOff},
      {"subnet", DiscoveryRange::kLocalhost},    {"nonsense", DiscoveryRange::kLocalhost}};
  for (const auto& [word, range] : words)
    EXPECT_EQ(settings({{"ROS_AUTOMATIC_DISCOVERY_RANGE", word}}).range, range) << word;
}

TEST(Discovery, StaticPeersAreSeparatedBySemicolons) {
  EXPECT_EQ(settings({{"ROS_STATIC_PEERS", "192.168.1.2;10.0.0.7"}}).static_peers,
            (std::vector<std::string>{"192.168.1.2", "10.0.0.7"}));
  EXPECT_EQ(settings({{"ROS_STATIC_PEERS", ";10.0.0.7;;"}}).static_peers, (std::vector<std::string>{"10.0.0.7"}));
}

TEST(Discovery, AllowedPeersAreAddressesOrNetworks) {
  const auto peers = settings({{"LAPIS_ALLOWED_PEERS", "192.168.1.7;10.0.0.9/8;1.2.3.4/0"}}).allowed_peers;
  ASSERT_EQ(peers.size(), 3U);
  EXPECT_TRUE(peers[0].contains(0xc0a80107));
  EXPECT_FALSE(peers[0].contains(0xc0a80108));
  EXPECT_TRUE(peers[1].contains(0x0aff0001));
  EXPECT_FALSE(peers[1].contains(0x0b000009));
  EXPECT_TRUE(peers[2].contains(0xffffffff));
  for (const char* bad : {"localhost", "10.0.0", "10.0.0.1/33", "10.0.0.1/", "10.0.0.1/-1", "10.0.0.1/8x", "::1"}) {
    EXPECT_THROW(settings({{"LAPIS_ALLOWED_PEERS", bad}}), std::runtime_error) << bad;
  }
}

TEST(Discovery, AllMaySendOnTheSubnetUnlessPeersAreNamed) {
  EXPECT_FALSE(allowed_senders(settings({})));
  EXPECT_FALSE(allowed_senders(settings({{"ROS_STATIC_PEERS", "10.0.0.7"}})));
  EXPECT_TRUE(allowed_senders(settings({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}}))->empty());
  EXPECT_EQ(allowed_senders(settings({{"LAPIS_ALLOWED_PEERS", "10.0.0.7"}, {"ROS_STATIC_PEERS", "10.0.0.8"}}))->size(),
            2U);
  EXPECT_FALSE(allowed_senders(
      settings({{"ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST"}, {"ROS_DISCOVERY_SERVER", "10.0.0.1:11811"}})))
      << "the server introduces hosts that nobody has named";
}

TEST(Discovery, RunIsAnIdThatFitsIntoUserData) {
  EXPECT_EQ(settings({}).run, "");
  EXPECT_EQ(settings({{"LAPIS_RUN", "Run_7.a-b"}}).run, "Run_7.a-b");
  EXPECT_EQ(settings({{"LAPIS_RUN", "a"}, {"ROS_LOCALHOST_ONLY", "1"}}).run, "a");
  for (const std::string& bad : {std::string("a;b"), std::string("a=b"), std::string("a b"), std::string(65, 'a')}) {
    EXPECT_THROW(settings({{"LAPIS_RUN", bad}}), std::runtime_error) << bad;
  }
}

TEST(Discovery, LocalhostOnlyOverridesTheOtherTwo) {
  const auto found = settings({{"ROS_LOCALHOST_ONLY", "1"},
                               {"ROS_AUTOMATIC_DISCOVERY_RANGE", "SUBNET"},
                               {"ROS_STATIC_PEERS", "10.0.0.7"},
                               {"ROS_DOMAIN_ID", "3"}});
  EXPECT_EQ(found.range, DiscoveryRange::kLocalhost);
  EXPECT_TRUE(found.static_peers.empty());
  EXPECT_EQ(found.domain, 3);
  EXPECT_EQ(settings({{"ROS_LOCALHOST_ONLY", "0"}, {"ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF"}}).range,
            DiscoveryRange::kOff);
}

}  // namespace
}  // namespace lapis::dds
