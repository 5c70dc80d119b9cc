#pragma once

#include "common/cdr/layout.hpp"
#include "common/cdr/value.hpp"

namespace lapis::cdr {

/// The layout of a type by its type_description_interfaces/msg/TypeDescription, which nodes of ROS 2 give of the types
/// that they publish. Throws std::runtime_error when it is incomplete, or has types that CDR of ROS 2 does not (wide
/// strings, long double).
Layout layout_of_description(const Value& description);

}  // namespace lapis::cdr
