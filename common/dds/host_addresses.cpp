#include "common/dds/host_addresses.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>

namespace lapis::dds {
namespace {

constexpr std::uint32_t kLoopbackNetwork = 127;  // its first byte; Linux answers on all of its addresses

template <class Visitor>
void for_each_ipv4_interface(Visitor&& visit) {
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return;
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr != nullptr && entry->ifa_addr->sa_family == AF_INET) visit(*entry);
  }
  ::freeifaddrs(list);
}

}  // namespace

bool has_network_interface() {
  bool has_one = false;
  for_each_ipv4_interface([&](const ifaddrs& entry) {
    has_one |= (entry.ifa_flags & IFF_RUNNING) != 0 && (entry.ifa_flags & IFF_LOOPBACK) == 0;
  });
  return has_one;
}

HostAddresses::Addresses HostAddresses::read_addresses() {
  Addresses addresses;
  for_each_ipv4_interface([&](const ifaddrs& entry) {
    sockaddr_in address{};
    std::memcpy(&address, entry.ifa_addr, sizeof address);
    addresses.push_back(ntohl(address.sin_addr.s_addr));
  });
  return addresses;
}

bool HostAddresses::contains(std::uint32_t address, Clock::time_point now) {
  if (address >> 24U == kLoopbackNetwork) return true;
  const std::lock_guard lock(mutex_);
  if (now >= expires_) {
    addresses_ = read_();
    expires_ = now + kLongestTrust;
  }
  return std::find(addresses_.begin(), addresses_.end(), address) != addresses_.end();
}

}  // namespace lapis::dds
