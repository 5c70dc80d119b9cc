#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

namespace lapis::dds {

/// Whether an interface besides the loopback one is up and has an IPv4 address. Fast DDS uses those that are up when a
/// process starts: on one that comes up later, no other host reaches the process.
bool has_network_interface();

/// The IPv4 addresses of this host, the first byte highest, also those that it gets while the process runs (Fast DDS
/// reads them once). What is known is never older than a second.
class HostAddresses {
 public:
  using Clock = std::chrono::steady_clock;
  using Addresses = std::vector<std::uint32_t>;

  /// @param read other functions are for tests
  explicit HostAddresses(std::function<Addresses()> read = read_addresses) : read_(std::move(read)) {}

  /// From any thread.
  bool contains(std::uint32_t address, Clock::time_point now = Clock::now());
  /// Asks the kernel; without an answer there are none.
  static Addresses read_addresses();

 private:
  static constexpr std::chrono::seconds kLongestTrust{1};

  const std::function<Addresses()> read_;
  std::mutex mutex_;
  Addresses addresses_;
  Clock::time_point expires_ = Clock::time_point::min();
};

}  // namespace lapis::dds
