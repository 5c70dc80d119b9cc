#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <stdexcept>

#include "simulator/core/assets/furniture_catalog.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    for (const auto& entry : lapis::simulator::parse_catalog(std::span(data, size), "fuzz")) {
      if (entry.id.empty() || !(entry.size_m.minCoeff() > 0) || !entry.model_rotation.allFinite()) std::abort();
    }
  } catch (const std::runtime_error&) {  // refused with a reason
  }
  return 0;
}
