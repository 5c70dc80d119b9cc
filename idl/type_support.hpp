#pragma once

namespace lapis::idl {

/// Names of a message type on the wire. Every struct of every package has a specialisation in "idl/<package>.hpp":
///
///     using PubSubType = ...;                 Fast DDS's type support of T
///     static constexpr const char* kRosName;  "sensor_msgs/msg/Image"
///     static constexpr const char* kDdsName;  "sensor_msgs::msg::dds_::Image_", the registered type name
///     static constexpr const char* kHash;     "RIHS01_...", ROS 2's hash of the declaration
///     static constexpr bool kIsKeyed;         has @key members: only for plain DDS topics, ROS 2 has no keys
template <typename T>
struct TypeSupport;

/// A service. An empty tag type names it, as in ROS 2's C++ (std_srvs::srv::Trigger); specialised in
/// "idl/<package>.hpp":
///
///     using Request = ...; using Response = ...;
///     static constexpr const char* kRosName;  "std_srvs/srv/Trigger"
///     static constexpr const char* kHash;     hash of the service; endpoints carry those of Request and Response
template <typename T>
struct ServiceSupport;

/// An action, by an empty tag type as a service (lapis_msgs::action::Explore); specialised in "idl/<package>.hpp":
///
///     using Goal = ...; using Result = ...; using Feedback = ...;
///     using SendGoal = ...; using GetResult = ...;   tags of services
///     using FeedbackMessage = ...;
///     static constexpr const char* kRosName;  "lapis_msgs/action/Explore"
///     static constexpr const char* kHash;     hash of the action; endpoints carry those of their messages
template <typename T>
struct ActionSupport;

}  // namespace lapis::idl
