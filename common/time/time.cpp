#include "common/time/time.hpp"

#include <cinttypes>
#include <cstdio>

namespace lapis::time {

std::string to_string(Time t) {
  const bool negative = t.nanoseconds < 0;
  const std::uint64_t magnitude =
      negative ? ~static_cast<std::uint64_t>(t.nanoseconds) + 1 : static_cast<std::uint64_t>(t.nanoseconds);
  char text[40];
  std::snprintf(text, sizeof text, "%s%" PRIu64 ".%09" PRIu64, negative ? "-" : "", magnitude / 1000000000u,
                magnitude % 1000000000u);
  return text;
}

}  // namespace lapis::time
