#pragma once

#include "idl/cdr.hpp"

#include <cstdint>
#include <vector>

namespace lapis::idl::test {

using Bytes = std::vector<std::uint8_t>;

/// What a writer of T puts on the wire: four bytes of encapsulation, then CDR.
template <typename T>
Bytes serialize(const T& message) {
  Bytes bytes(encoded_bytes(message));
  bytes.resize(encode(message, bytes));
  return bytes;
}

}  // namespace lapis::idl::test
