#include "common/runtime/type_description.hpp"

#include <map>
#include <string>
#include <vector>

#include "idl/type_table.hpp"

namespace lapis::runtime {
namespace {

using type_description_interfaces::msg::IndividualTypeDescription;
using type_description_interfaces::msg::TypeSource;
using Response = type_description_interfaces::srv::GetTypeDescription_Response;

IndividualTypeDescription description_of(const idl::TypeEntry& type) {
  IndividualTypeDescription description;
  description.type_name(std::string(type.ros_name));
  for (const idl::FieldEntry& entry : type.fields) {
    type_description_interfaces::msg::Field field;
    field.name(std::string(entry.name));
    field.type().type_id(entry.type_id);
    field.type().capacity(entry.capacity);
    field.type().string_capacity(entry.string_capacity);
    field.type().nested_type_name(std::string(entry.nested_type));
    description.fields().push_back(field);
  }
  return description;
}

/// The types that a type uses, directly or not, by name.
std::map<std::string_view, const idl::TypeEntry*> used_by(const idl::TypeEntry& type) {
  std::map<std::string_view, const idl::TypeEntry*> used;
  std::vector<const idl::TypeEntry*> todo = {&type};
  while (!todo.empty()) {
    const idl::TypeEntry* user = todo.back();
    todo.pop_back();
    for (const idl::FieldEntry& field : user->fields) {
      if (field.nested_type.empty()) continue;
      const idl::TypeEntry* found = idl::find(field.nested_type);
      if (used.emplace(found->ros_name, found).second) todo.push_back(found);
    }
  }
  return used;
}

/// The text of the type alone, which comes first in its schema.
TypeSource source_of(const idl::TypeEntry& type) {
  static const std::string kNext = std::string(80, '=') + "\n";
  TypeSource source;
  source.type_name(std::string(type.ros_name));
  source.encoding("msg");
  source.raw_file_contents(std::string(type.ros2msg_text.substr(0, type.ros2msg_text.find(kNext))));
  return source;
}

Response failure(const std::string& reason) {
  Response response;
  response.successful(false);
  response.failure_reason(reason);
  return response;
}

}  // namespace

Response describe_type(const type_description_interfaces::srv::GetTypeDescription_Request& request) {
  const idl::TypeEntry* type = idl::find(request.type_name());
  if (type == nullptr) return failure("no type '" + request.type_name() + "' is known here");
  if (!request.type_hash().empty() && request.type_hash() != type->hash) {
    return failure(request.type_name() + " has the hash " + std::string(type->hash) + " here");
  }
  Response response;
  response.successful(true);
  response.type_description().type_description(description_of(*type));
  if (request.include_type_sources()) response.type_sources().push_back(source_of(*type));
  for (const auto& [name, used] : used_by(*type)) {
    response.type_description().referenced_type_descriptions().push_back(description_of(*used));
    if (request.include_type_sources()) response.type_sources().push_back(source_of(*used));
  }
  return response;
}

}  // namespace lapis::runtime
