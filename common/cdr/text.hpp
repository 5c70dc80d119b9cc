#pragma once

#include <cstddef>
#include <string>

#include "common/cdr/value.hpp"

namespace lapis::cdr {

/// Number of elements that `ros2 topic echo` prints of a list.
inline constexpr std::size_t kLongestList = 128;

/// The message as YAML, one field a line, as `ros2 topic echo` prints it; "..." stands for the elements of a list
/// beyond `longest_list`.
std::string to_yaml(const Value& value, std::size_t longest_list = kLongestList);

/// One line of JSON. NaN and infinity are null; bytes that are no UTF-8 become U+FFFD.
std::string to_json(const Value& value);

/// Reads YAML, of which JSON is a part. All scalars are texts, which encode() understands; null stays null. Throws
/// std::runtime_error when the text is no YAML.
Value from_yaml(const std::string& text);

/// Part of a message: "pose.position.x", "transforms[0].header" or "transforms.0". Throws std::runtime_error, which
/// names what there is.
const Value& field_of(const Value& message, const std::string& path);

}  // namespace lapis::cdr
