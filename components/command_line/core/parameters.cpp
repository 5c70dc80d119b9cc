#include "command_line/core/parameters.hpp"

#include <array>
#include <charconv>
#include <stdexcept>

#include "common/cdr/text.hpp"

namespace lapis::command_line {
namespace {

enum ParameterType : int {
  kNotSet,
  kBool,
  kInteger,
  kDouble,
  kString,
  kByteArray,
  kBoolArray,
  kIntegerArray,
  kDoubleArray,
  kStringArray,
  kTypes
};

/// rcl_interfaces/msg/ParameterType, by number.
struct TypeRow {
  const char* field;
  const char* name;
};
constexpr std::array<TypeRow, kTypes> kRows{{{"", "not set"},
                                             {"bool_value", "a truth value"},
                                             {"integer_value", "an integer"},
                                             {"double_value", "a number"},
                                             {"string_value", "a text"},
                                             {"byte_array_value", "a list of bytes"},
                                             {"bool_array_value", "a list of truth values"},
                                             {"integer_array_value", "a list of integers"},
                                             {"double_array_value", "a list of numbers"},
                                             {"string_array_value", "a list of texts"}}};

const TypeRow& row_of(int type) {
  return type > kNotSet && type < kTypes ? kRows[static_cast<std::size_t>(type)] : kRows[0];
}

template <class Number>
bool is_number(const std::string& text) {
  Number number{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  return result.ec == std::errc() && result.ptr == text.data() + text.size();
}

int type_of_scalar(const cdr::Value& scalar) {
  if (!scalar.is_string()) return kString;
  const std::string text = scalar.get<std::string>();
  if (text == "true" || text == "false") return kBool;
  if (is_number<std::int64_t>(text)) return kInteger;
  return is_number<double>(text) ? kDouble : kString;
}

int type_of(const cdr::Value& value) {
  if (!value.is_array()) return type_of_scalar(value);
  const int of_elements = value.empty() ? kString : type_of_scalar(value.front());
  return of_elements == kBool ? kBoolArray : kIntegerArray + of_elements - kInteger;
}

}  // namespace

cdr::Value content_of(const cdr::Value& parameter_value) {
  const auto type = parameter_value.find("type");
  if (type == parameter_value.end() || !type->is_number_integer()) return {};
  const TypeRow& row = row_of(type->get<int>());
  return *row.field == '\0' ? cdr::Value() : parameter_value.at(row.field);
}

cdr::Value to_parameter_value(const std::string& text, int type) {
  const bool is_text = type == kString;  // as it is: "a: b" is no map here
  const cdr::Value value = is_text ? cdr::Value(text) : cdr::from_yaml(text);
  const int chosen = type == kNotSet ? type_of(value) : type;
  const TypeRow& row = row_of(chosen);
  if (*row.field == '\0') throw std::runtime_error("parameters of type " + std::to_string(type) + " are not known");
  if (value.is_array() != (chosen >= kByteArray) || value.is_object()) {
    throw std::runtime_error("'" + text + "' is not " + row.name);
  }
  return {{"type", chosen}, {row.field, value}};
}

std::string type_name(int type) { return row_of(type).name; }

cdr::Value as_tree(const cdr::Value& flat) {
  cdr::Value tree = cdr::Value::object();
  for (const auto& [name, value] : flat.items()) {
    cdr::Value* place = &tree;
    std::size_t begin = 0;
    for (std::size_t dot = name.find('.'); dot != std::string::npos; dot = name.find('.', begin)) {
      place = &(*place)[name.substr(begin, dot - begin)];
      begin = dot + 1;
    }
    (*place)[name.substr(begin)] = value;
  }
  return tree;
}

}  // namespace lapis::command_line
