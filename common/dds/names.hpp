#pragma once

#include <string>

namespace lapis::dds {

/// Puts a robot's namespace in front of a name: ("/slam/odometry", "robot1") -> "/robot1/slam/odometry" and
/// ("lapis/x", "robot1") -> "robot1/lapis/x". An empty namespace changes nothing.
std::string in_namespace(const std::string& name, const std::string& name_space);

/// DDS name of a topic: ROS names ("/a/b") become "rt/a/b"; plain DDS names (no leading slash) stay as they are.
std::string topic_dds_name(const std::string& ros_name);
std::string request_dds_name(const std::string& service);  ///< "/a/s" -> "rq/a/sRequest"
std::string reply_dds_name(const std::string& service);    ///< "/a/s" -> "rr/a/sReply"

/// Checks a namespace as ROS 2 does (letters, digits, underscore, slash between; may be empty). Throws
/// std::runtime_error, whose message says what is allowed.
void check_namespace(const std::string& name_space);

}  // namespace lapis::dds
