#pragma once

#include <string_view>

#include "common/cdr/layout.hpp"
#include "common/cdr/value.hpp"

namespace lapis::cdr {

/// Decodes a message. Throws std::runtime_error when the bytes are none: too few, a length beyond their end, or another
/// encoding than plain CDR. Bytes behind the message are left out, because RTPS pads. A float32 becomes the shortest
/// decimal number that stands for it.
/// @param end name of a field of the message: it and those behind it are left out, such as the pixels of an image
Value decode(const Layout& layout, const Bytes& bytes, std::string_view end = {});

}  // namespace lapis::cdr
