#include "common/cdr/text.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

namespace lapis::cdr {
namespace {

constexpr auto kReplace = Value::error_handler_t::replace;

/// Whether YAML takes a text for itself, without quotes.
bool is_plain(const std::string& text) {
  constexpr std::array<std::string_view, 10> kWords{"true", "false", "yes", "no", "on",
                                                    "off",  "null",  "y",   "n",  "none"};
  const auto is_letter = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '/';
  };
  const auto is_allowed = [&](char c) {
    return is_letter(c) || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == ' ' || c == '(' || c == ')' ||
           c == ',';
  };
  if (text.empty() || text.back() == ' ' || !is_letter(text.front())) return false;
  if (!std::all_of(text.begin(), text.end(), is_allowed)) return false;
  std::string lower = text;
  std::ranges::transform(lower, lower.begin(),
                         [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  return std::ranges::find(kWords, lower) == kWords.end();
}

std::string number_text(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  return Value(value).dump();
}

std::string scalar_text(const Value& value) {
  if (value.is_number_float()) return number_text(value.get<double>());
  if (value.is_string() && is_plain(value.get_ref<const std::string&>())) return value.get<std::string>();
  if (value.is_string() && value.get_ref<const std::string&>().empty()) return "''";
  return value.dump(-1, ' ', false, kReplace);
}

void write(const Value& value, const std::string& indent, std::size_t longest_list, std::string& text);

/// Writes what follows "name:" or "-".
void write_content(const Value& value, const std::string& indent, std::size_t longest_list, std::string& text) {
  if (value.is_structured() && !value.empty()) {
    text += '\n';
    return write(value, indent, longest_list, text);
  }
  text += ' ' + (value.is_object() ? "{}" : value.is_array() ? "[]" : scalar_text(value)) + '\n';
}

/// An element that is a structure begins behind its dash.
void write_element(const Value& value, const std::string& indent, std::size_t longest_list, std::string& text) {
  text += indent + '-';
  if (!value.is_object() || value.empty()) return write_content(value, indent + "  ", longest_list, text);
  const std::size_t begin = text.size();
  write(value, indent + "  ", longest_list, text);
  text.replace(begin, indent.size() + 2, " ");
}

void write(const Value& value, const std::string& indent, std::size_t longest_list, std::string& text) {
  if (value.is_array()) {
    for (std::size_t i = 0; i < std::min(longest_list, value.size()); ++i) {
      write_element(value[i], indent, longest_list, text);
    }
    if (value.size() > longest_list) text += indent + "- '...'\n";
    return;
  }
  for (const auto& [name, content] : value.items()) {
    text += indent + name + ':';
    write_content(content, content.is_array() ? indent : indent + "  ", longest_list, text);
  }
}

Value to_value(const YAML::Node& node) {
  if (node.IsMap()) {
    Value value = Value::object();
    for (const auto& entry : node) value[entry.first.as<std::string>()] = to_value(entry.second);
    return value;
  }
  if (node.IsSequence()) {
    Value value = Value::array();
    for (const auto& element : node) value.push_back(to_value(element));
    return value;
  }
  return node.IsScalar() ? Value(node.Scalar()) : Value();
}

std::string names_in(const Value& value) {
  if (value.is_array()) return "a list of " + std::to_string(value.size());
  if (!value.is_object()) return "no fields";
  std::string names;
  for (const auto& [name, content] : value.items()) names += (names.empty() ? "" : ", ") + name;
  return names;
}

[[noreturn]] void fail_without(const std::string& field, const std::string& path, const Value& value) {
  throw std::runtime_error("no field '" + field + "' of '" + path + "'; there is " + names_in(value));
}

/// "transforms[0].header" -> {"transforms", "0", "header"}
std::vector<std::string> steps_of(std::string path) {
  std::ranges::replace(path, '[', '.');
  std::erase(path, ']');
  std::vector<std::string> steps;
  std::size_t begin = 0;
  for (std::size_t end = 0; end != std::string::npos; begin = end + 1) {
    end = path.find('.', begin);
    steps.push_back(path.substr(begin, end - begin));
  }
  return steps;
}

}  // namespace

std::string to_yaml(const Value& value, std::size_t longest_list) {
  if (!value.is_structured()) return scalar_text(value) + "\n";
  if (value.empty()) return value.is_array() ? "[]\n" : "{}\n";
  std::string text;
  write(value, "", longest_list, text);
  return text;
}

std::string to_json(const Value& value) { return value.dump(-1, ' ', false, kReplace); }

Value from_yaml(const std::string& text) {
  try {
    return to_value(YAML::Load(text));
  } catch (const YAML::Exception& error) {
    throw std::runtime_error("'" + text + "' is neither YAML nor JSON: " + error.msg);
  }
}

const Value& field_of(const Value& message, const std::string& path) {
  const Value* value = &message;
  for (const std::string& step : steps_of(path)) {
    std::size_t index = 0;
    const auto result = std::from_chars(step.data(), step.data() + step.size(), index);
    const bool is_index = result.ec == std::errc() && result.ptr == step.data() + step.size();
    if (value->is_object() && value->contains(step)) {
      value = &(*value)[step];
    } else if (value->is_array() && is_index && index < value->size()) {
      value = &(*value)[index];
    } else {
      fail_without(step, path, *value);
    }
  }
  return *value;
}

}  // namespace lapis::cdr
