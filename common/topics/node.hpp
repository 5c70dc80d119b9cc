#pragma once

#include "common/dds/topic.hpp"
#include "idl/rcl_interfaces.hpp"
#include "idl/type_description_interfaces.hpp"

namespace lapis::topics {

// What every process except the supervisor offers as a node of ROS 2.
inline constexpr dds::Topic<rcl_interfaces::msg::Log> kRosout{
    "/rosout", dds::kLog, "all but the supervisor", "on change", "each line of the log", true, true};
inline constexpr dds::Topic<rcl_interfaces::msg::ParameterEvent> kParameterEvents{"/parameter_events",
                                                                                  dds::kNodeEvent,
                                                                                  "all but the supervisor",
                                                                                  "on change",
                                                                                  "parameters that were set",
                                                                                  true,
                                                                                  true};

// Services of each process, whose own name comes first: "/slam/list_parameters".
inline constexpr dds::ServiceTopic<rcl_interfaces::srv::ListParameters> kListParameters{
    "/list_parameters", "all but the supervisor", "names of the configuration keys"};
inline constexpr dds::ServiceTopic<rcl_interfaces::srv::GetParameters> kGetParameters{
    "/get_parameters", "all but the supervisor", "their values"};
inline constexpr dds::ServiceTopic<rcl_interfaces::srv::GetParameterTypes> kGetParameterTypes{
    "/get_parameter_types", "all but the supervisor", "their types"};
inline constexpr dds::ServiceTopic<rcl_interfaces::srv::DescribeParameters> kDescribeParameters{
    "/describe_parameters", "all but the supervisor", "types, meanings, bounds, and whether they are read at start"};
inline constexpr dds::ServiceTopic<rcl_interfaces::srv::SetParameters> kSetParameters{
    "/set_parameters", "all but the supervisor", "change those that may change at run time", false, true};
inline constexpr dds::ServiceTopic<rcl_interfaces::srv::SetParametersAtomically> kSetParametersAtomically{
    "/set_parameters_atomically", "all but the supervisor", "the same, all or none", false, true};
inline constexpr dds::ServiceTopic<type_description_interfaces::srv::GetTypeDescription> kGetTypeDescription{
    "/get_type_description", "all but the supervisor", "members of a message type that this build knows"};

}  // namespace lapis::topics
