#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace lapis::idl {

/// A member of a message type, as type_description_interfaces/msg/FieldType describes it.
struct FieldEntry {
  std::string_view name;
  std::uint8_t type_id;
  std::uint64_t capacity;
  std::uint64_t string_capacity;
  std::string_view nested_type;  ///< ROS name, or empty
};

/// A message type of this build, for code that looks up types by name (recording, probing).
struct TypeEntry {
  std::string_view ros_name;      ///< "sensor_msgs/msg/Image"
  std::string_view dds_name;      ///< "sensor_msgs::msg::dds_::Image_"
  std::string_view hash;          ///< "RIHS01_..."
  std::string_view ros2msg_text;  ///< schema with all dependencies, in the format of rosbag2 (encoding `ros2msg`)
  std::span<const FieldEntry> fields;
};

/// All types, sorted by ROS name.
std::span<const TypeEntry> type_table();

/// The type with this ROS name; nullptr when there is none.
const TypeEntry* find(std::string_view ros_name);

}  // namespace lapis::idl
