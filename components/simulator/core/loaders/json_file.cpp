#include "simulator/core/loaders/json_file.hpp"

#include <stdexcept>

namespace lapis::simulator {
namespace {

using nlohmann::json;

[[noreturn]] void fail(const std::string& file, std::string_view key, const std::string& what) {
  throw std::runtime_error(file + ": '" + std::string(key) + "' must be " + what +
                           "; correct it or export the file again");
}

}  // namespace

json parse_json_object(std::string_view text, const std::string& file) {
  try {
    json result = json::parse(text.begin(), text.end());
    if (!result.is_object()) throw std::runtime_error(file + ": there is no JSON object in it; export the file again");
    return result;
  } catch (const json::parse_error& error) {
    throw std::runtime_error(file + ": no valid JSON text at byte " + std::to_string(error.byte) +
                             "; correct it or export the file again");
  } catch (const json::out_of_range&) {
    throw std::runtime_error(file + ": a number in the JSON text is too large; correct it or export the file again");
  }
}

const json& member(const json& object, std::string_view key) {
  static const json kNull;
  if (!object.is_object()) return kNull;
  const auto it = object.find(key);
  return it == object.end() ? kNull : *it;
}

const json& array_member(const json& object, std::string_view key, const std::string& file) {
  static const json kEmpty = json::array();
  const json& value = member(object, key);
  if (value.is_null()) return kEmpty;
  if (!value.is_array()) fail(file, key, "an array");
  return value;
}

std::string text_member(const json& object, std::string_view key, const std::string& file,
                        const std::string& fallback) {
  const json& value = member(object, key);
  if (value.is_null()) return fallback;
  if (!value.is_string()) fail(file, key, "text");
  return value.get<std::string>();
}

std::size_t index_member(const json& object, std::string_view key, const std::string& file, std::size_t fallback) {
  const json& value = member(object, key);
  if (value.is_null()) return fallback;
  if (!value.is_number_unsigned()) fail(file, key, "a whole number from 0");
  return value.get<std::size_t>();
}

void read_numbers(const json& object, std::string_view key, const std::string& file, std::span<double> values) {
  const json& array = member(object, key);
  if (array.is_null()) return;
  if (!array.is_array() || array.size() != values.size()) fail(file, key, std::to_string(values.size()) + " numbers");
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!array[i].is_number()) fail(file, key, std::to_string(values.size()) + " numbers");
    values[i] = array[i].get<double>();
  }
}

}  // namespace lapis::simulator
