#pragma once

#include <string>

#include "common/config/schema.hpp"

namespace lapis::config {

/// Text of a configuration file. Throws Error unless it is a regular file of at most 16 MiB of UTF-8.
std::string read_text(const std::string& file);
/// Reads a YAML file into the structs behind `schema`. Keys that the file leaves out keep their value. Throws Error
/// when the file cannot be read, holds an unknown or repeated key, or a value of wrong type or range. An old key
/// (Schema::moved) is refused with its new name.
void apply_file(const Schema& schema, const std::string& file);
/// The same for YAML text; `source` names it in messages.
void apply_text(const Schema& schema, const std::string& text, const std::string& source);
/// Applies one "path=value" as given to --set.
void apply_override(const Schema& schema, const std::string& assignment);
/// Throws Error for the first broken rule: its text, with the value after each key.
void check(const Schema& schema, const Rules& rules);
/// The whole configuration as a YAML file with a comment per key; reading it back changes nothing.
std::string to_yaml(const Schema& schema);

}  // namespace lapis::config
