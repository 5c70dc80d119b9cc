#pragma once

#include <map>
#include <string>
#include <vector>

namespace lapis::dds {

/// Puts a robot's namespace in front of a name: ("/slam/odometry", "robot1") -> "/robot1/slam/odometry" and
/// ("lapis/x", "robot1") -> "robot1/lapis/x". An empty namespace changes nothing.
std::string in_namespace(const std::string& name, const std::string& name_space);

/// DDS name of a topic: ROS names ("/a/b") become "rt/a/b"; plain DDS names (no leading slash) stay as they are.
std::string topic_dds_name(const std::string& ros_name);
std::string request_dds_name(const std::string& service);  ///< "/a/s" -> "rq/a/sRequest"
std::string reply_dds_name(const std::string& service);    ///< "/a/s" -> "rr/a/sReply"

/// How a process calls topics, services and frames.
struct Names {
  std::string name_space;                       ///< "robot1" or empty
  std::map<std::string, std::string> remapped;  ///< names without namespace, by those of docs/topics.md

  /// The name that others see: remapped, and in the robot's namespace unless it is global.
  std::string full(const std::string& name, bool is_global = false) const;
};

/// Reads rules "/camera/color/image_raw:=/rgb/image_raw" or "base_link:=base_footprint"; the last rule for a name
/// counts. Throws std::runtime_error, which names the rule and the remedy, for a rule of another form, of a name that
/// is not among `known`, or with a new name that ROS 2 does not allow.
std::map<std::string, std::string> parse_remaps(const std::vector<std::string>& rules,
                                                const std::vector<std::string>& known);

/// Checks a namespace as ROS 2 does (letters, digits, underscore, slash between; may be empty). Throws
/// std::runtime_error, whose message says what is allowed.
void check_namespace(const std::string& name_space);

}  // namespace lapis::dds
