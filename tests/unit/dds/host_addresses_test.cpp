#include "common/dds/host_addresses.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace lapis::dds {
namespace {

constexpr std::uint32_t kLoopback = 0x7f000001, kCable = 0x0a010203, kWifi = 0xc0a80107;

TEST(HostAddresses, WhatTheHostGetsOrLosesLaterIsKnownAfterASecond) {
  HostAddresses::Addresses now{kCable};
  int reads = 0;
  HostAddresses host([&] {
    ++reads;
    return now;
  });
  const HostAddresses::Clock::time_point start{};
  EXPECT_TRUE(host.contains(kCable, start));
  EXPECT_FALSE(host.contains(kWifi, start));
  now = {kWifi};
  for (int ms = 0; ms < 1000; ms += 100) EXPECT_FALSE(host.contains(kWifi, start + std::chrono::milliseconds(ms)));
  EXPECT_EQ(reads, 1);
  EXPECT_TRUE(host.contains(kWifi, start + std::chrono::seconds(1)));
  EXPECT_FALSE(host.contains(kCable, start + std::chrono::seconds(1)));
  EXPECT_EQ(reads, 2);
}

TEST(HostAddresses, LoopbackNeedsNoInterface) {
  HostAddresses host([] { return HostAddresses::Addresses{}; });
  EXPECT_TRUE(host.contains(kLoopback));
  EXPECT_TRUE(host.contains(kLoopback + 41));
  EXPECT_FALSE(host.contains(0x80000001));
}

TEST(HostAddresses, TheKernelKnowsTheLoopbackInterface) {
  const auto addresses = HostAddresses::read_addresses();
  EXPECT_NE(std::find(addresses.begin(), addresses.end(), kLoopback), addresses.end());
}

}  // namespace
}  // namespace lapis::dds
