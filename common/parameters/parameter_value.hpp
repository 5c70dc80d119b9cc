#pragma once

#include <string>

#include "common/config/schema.hpp"
#include "idl/rcl_interfaces.hpp"

namespace lapis::parameters {

/// The value of a configuration key as a parameter: int and int64 are integers, Words an array of strings, Numbers an
/// array of doubles.
rcl_interfaces::msg::ParameterValue to_value(const config::Entry& entry);

/// Type, meaning and bounds of a configuration key. A bound of one side has infinity (for integers the end of the
/// type's range) on the other; words and bounds of lists are a text, because ROS 2 has no field for them.
rcl_interfaces::msg::ParameterDescriptor to_descriptor(const config::Entry& entry);

/// Sets the key to a value of its type within its bound. An integer is a double, too, as in configuration files.
/// Returns why it refuses, and then nothing has changed; empty: it is done.
std::string assign(const config::Entry& entry, const rcl_interfaces::msg::ParameterValue& value);

}  // namespace lapis::parameters
