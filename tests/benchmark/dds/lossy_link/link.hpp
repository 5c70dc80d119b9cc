#pragma once

#include <cstdint>

namespace lapis::test {

/// A link between two network namespaces, in user space.
struct LinkOptions {
  double loss_percent = 0.0;  ///< share of packets lost, each by itself, in both directions
  double delay_ms = 0.0;      ///< one way
  double mbit_per_s = 0.0;    ///< rate of each direction, with a queue of 50 ms; 0: any
  double outage_after_s = 0.0;
  double outage_s = 0.0;   ///< how long nothing arrives
  std::uint64_t seed = 1;  ///< the n-th packet of a direction is lost or not by the seed alone
};

/// Makes two network namespaces with a TUN device each and carries packets between them until SIGTERM or SIGINT. Prints
/// the files of the namespaces first ({"namespaces": [A, B]}), which exist as long as this process, and at the end, for
/// each direction, packets and bytes that came, and packets lost by chance and for want of memory. Needs root.
int run_link(const LinkOptions& options);

}  // namespace lapis::test
