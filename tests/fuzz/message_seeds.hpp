#pragma once

#include <cstdint>
#include <vector>

namespace lapis::fuzz {

/// First inputs of the fuzzer of messages: for each topic an empty message, and one whose lists have an element each.
std::vector<std::vector<std::uint8_t>> message_seeds();

}  // namespace lapis::fuzz
