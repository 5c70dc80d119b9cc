#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

namespace lapis::cdr {

/// A message by the names of its fields, in their order. NaN and infinity are numbers here, and null in JSON text.
using Value = nlohmann::ordered_json;
/// CDR with its encapsulation header.
using Bytes = std::vector<std::uint8_t>;
inline constexpr std::size_t kHeaderBytes = 4;

}  // namespace lapis::cdr
