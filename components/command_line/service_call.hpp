#pragma once

#include <string>

#include "command_line/domain.hpp"
#include "common/cdr/layout.hpp"
#include "common/cdr/value.hpp"

namespace lapis::command_line {

/// Calls a service and waits for the answer. Throws Failure when nobody serves it, when the request does not fit its
/// type, or when no answer comes.
/// @param service full name
cdr::Value call(Domain& domain, const std::string& service, const cdr::Value& request);

/// The fields of a type of this build, by its ROS name. Throws Failure when there is none.
cdr::Layout known_layout(const std::string& type);

/// False when the answer says so: `success` or `successful` is false.
bool is_success(const cdr::Value& response);

}  // namespace lapis::command_line
