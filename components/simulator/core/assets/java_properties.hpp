#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace lapis::simulator {

/// Keys and values of a Java .properties file (Latin-1 with \uXXXX escapes and continued lines; see the documentation
/// of java.util.Properties.load), as UTF-8. Of a key that occurs twice the last value counts. Every input is some
/// properties file; an escape that is not complete becomes U+FFFD.
std::map<std::string, std::string> parse_java_properties(std::span<const std::uint8_t> bytes);

}  // namespace lapis::simulator
