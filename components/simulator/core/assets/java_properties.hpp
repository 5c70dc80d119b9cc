#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace lapis::simulator {

/// Keys and values of a Java .properties file (Latin-1 with \uXXXX escapes and continued lines; see the documentation
/// of java.util.Properties.load), as UTF-8. When a key occurs twice, its last value counts. Every input is a valid
/// properties file; an incomplete escape becomes U+FFFD.
std::map<std::string, std::string> parse_java_properties(std::span<const std::uint8_t> bytes);

}  // namespace lapis::simulator
