#pragma once

#include <cstdint>

#include "common/dds/discovery.hpp"

namespace lapis::dds {

enum class Transport { kUdp, kSharedMemory };

/// How large samples (Qos::large) travel: images and tiles, hundreds of datagrams each.
struct LargeSettings {
  int bytes_per_period = 0;  ///< most bytes sent in a pace_period_ms; 0: write() sends all at once, in its own thread
  int pace_period_ms = 1;
  int depth = 0;                  ///< history depth at least, so that a sample is repaired before newer ones replace it
  std::int64_t heartbeat_ns = 0;  ///< 0: as for other samples
  std::int64_t heartbeat_response_ns = 0;  ///< how long a reader waits for what is under way before it asks again
  std::int64_t nack_suppression_ns = 0;    ///< how long a writer ignores that whole samples are asked for again
  bool heartbeat_with_data = true;         ///< false: only periodic heartbeats
};

/// How a participant sends, by what lies between it and the others.
struct LinkSettings {
  int message_bytes = 65'500;  ///< largest RTPS message, which is one UDP datagram
  LargeSettings large;
};

/// Nothing is lost: few and large datagrams, sent by write() itself, and an answer at once to what is missing.
inline constexpr LinkSettings kLoopbackLink{};

/// One datagram for each frame of Ethernet, so that a lost frame costs 1.4 kB, sent no faster than socket buffers of
/// the size that Linux grants by default take; and readers ask for what is missing when the rest of a sample has had
/// time to arrive. Found by tests/benchmark/dds/lossy_link.
inline constexpr LinkSettings kNetworkLink{.message_bytes = 1'400,
                                           .large = {.bytes_per_period = 80'000,
                                                     .pace_period_ms = 2,
                                                     .depth = 30,
                                                     .heartbeat_ns = 30'000'000,
                                                     .heartbeat_response_ns = 20'000'000,
                                                     .nack_suppression_ns = 500'000'000,
                                                     .heartbeat_with_data = false}};

/// Whether the loopback interface alone is used.
bool stays_on_host(const DiscoverySettings& discovery);

/// What lies between a participant and the others. Who asks for shared memory has its readers on this host: Fast DDS
/// gives all transports of a participant the smallest of their message sizes, and kNetworkLink would cut each image
/// into hundreds of messages and send them at the pace of a network. Other hosts get the large datagrams, too, which
/// needs a link that loses nothing.
LinkSettings link_of(const DiscoverySettings& discovery, Transport transport = Transport::kUdp);

}  // namespace lapis::dds
