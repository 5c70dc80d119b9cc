#pragma once

#include "common/cdr/layout.hpp"
#include "common/cdr/value.hpp"

namespace lapis::cdr {

/// Decodes a message. Throws std::runtime_error when the bytes are none: too few, a length beyond their end, or another
/// encoding than plain CDR. Bytes behind the message are left out, because RTPS pads. A float32 becomes the shortest
/// decimal number that stands for it.
Value decode(const Layout& layout, const Bytes& bytes);

}  // namespace lapis::cdr
