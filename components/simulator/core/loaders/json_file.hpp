#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace lapis::simulator {

/// Parses a JSON text. @throws std::runtime_error naming `file` and the place when it is not valid or no object.
nlohmann::json parse_json_object(std::string_view text, const std::string& file);

/// Member `key` of `object`; null when `object` has no such member, or is no object.
const nlohmann::json& member(const nlohmann::json& object, std::string_view key);

/// Member `key` as an array; an empty one when there is none. @throws std::runtime_error when it is no array.
const nlohmann::json& array_member(const nlohmann::json& object, std::string_view key, const std::string& file);

/// Member `key` as text; `fallback` when there is none. @throws std::runtime_error when it is no text.
std::string text_member(const nlohmann::json& object, std::string_view key, const std::string& file,
                        const std::string& fallback = {});

/// Member `key` as a whole number from 0; `fallback` when there is none. @throws std::runtime_error when it is none.
std::size_t index_member(const nlohmann::json& object, std::string_view key, const std::string& file,
                         std::size_t fallback);

/// Reads member `key`, an array of exactly `values.size()` numbers, into `values`, which stay as they are when there is
/// no such member.
/// @throws std::runtime_error when it is anything else.
void read_numbers(const nlohmann::json& object, std::string_view key, const std::string& file,
                  std::span<double> values);

}  // namespace lapis::simulator
