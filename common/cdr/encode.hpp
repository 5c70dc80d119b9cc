#pragma once

#include "common/cdr/layout.hpp"
#include "common/cdr/value.hpp"

namespace lapis::cdr {

/// Encodes a message as little-endian CDR. Fields that are not given are zero or empty; numbers and truth values may be
/// given as text. Throws std::runtime_error, which names the field and what is wanted.
Bytes encode(const Layout& layout, const Value& value);

}  // namespace lapis::cdr
