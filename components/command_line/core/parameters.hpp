#pragma once

#include <string>

#include "common/cdr/value.hpp"

namespace lapis::command_line {

// Parameters as rcl_interfaces has them, and as people write them.

/// Content of a rcl_interfaces/msg/ParameterValue; null: not set.
cdr::Value content_of(const cdr::Value& parameter_value);

/// The rcl_interfaces/msg/ParameterValue of a text, of the type that the parameter has now. A type of "not set" (0)
/// takes the type that the text looks like. Throws std::runtime_error when the text is no such value.
cdr::Value to_parameter_value(const std::string& text, int type);

/// "a boolean", "a list of numbers", ...
std::string type_name(int type);

/// {"a.b": 1} -> {"a": {"b": 1}}
cdr::Value as_tree(const cdr::Value& flat);

}  // namespace lapis::command_line
