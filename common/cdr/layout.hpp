#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace lapis::cdr {

enum class Kind {
  kBool,
  kByte,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64,
  kString,
  kStructure
};

enum class Container { kNone, kArray, kSequence };

struct Field {
  std::string name;
  Kind kind = Kind::kBool;
  std::size_t structure = 0;  ///< of kStructure: index into Layout::structures
  Container container = Container::kNone;
  std::size_t capacity = 0;      ///< size of an array, bound of a sequence; 0: no bound
  std::size_t string_bound = 0;  ///< most characters of a string; 0: no bound
};

struct Structure {
  std::string name;           ///< "std_msgs/Header"
  std::vector<Field> fields;  ///< none: one byte on the wire, as IDL has no empty structures
};

/// The fields of a message and of everything in it. The message itself is the first structure.
struct Layout {
  std::vector<Structure> structures;
};

/// Reads a declaration as bags have it (encoding `ros2msg`): the fields of the message and, behind a line of '=' and
/// `MSG: package/Name`, those of each type that it uses. Constants and comments are left out.
/// @param ros_name "geometry_msgs/msg/Twist"
/// Throws std::runtime_error, which names the line, where the text is no such declaration.
Layout parse_ros2msg(std::string_view ros_name, std::string_view text);

/// Throws std::runtime_error where a structure contains itself.
void require_an_end(const Layout& layout);

}  // namespace lapis::cdr
