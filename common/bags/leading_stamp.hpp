#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "common/time/time.hpp"

namespace lapis::bags {

/// Stamp of a message that begins with one, as all with a std_msgs/Header do; nothing when it is too short, no time, or
/// its encapsulation is not plain CDR.
std::optional<time::Time> leading_stamp(const std::vector<std::uint8_t>& cdr);

}  // namespace lapis::bags
