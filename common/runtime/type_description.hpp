#pragma once

#include "idl/type_description_interfaces.hpp"

namespace lapis::runtime {

/// The members of a message type of this build and of all types in it; the hash, unless it is empty, has to be its.
/// Sources are texts of .msg files without comments.
type_description_interfaces::srv::GetTypeDescription_Response describe_type(
    const type_description_interfaces::srv::GetTypeDescription_Request& request);

}  // namespace lapis::runtime
