#include "simulator/core/assets/java_properties.hpp"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

namespace lapis::simulator {
namespace {

constexpr std::string_view kBlanks = " \t\f";
constexpr std::uint32_t kReplacement = 0xFFFD;

void append_utf8(std::uint32_t code, std::string& text) {
  const auto put = [&](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (code < 0x80) {
    put(code);
  } else if (code < 0x800) {
    put(0xC0 | code >> 6);
    put(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3F));
    put(0x80 | (code & 0x3F));
  } else {
    put(0xF0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3F));
    put(0x80 | (code >> 6 & 0x3F));
    put(0x80 | (code & 0x3F));
  }
}

// Removes the first natural line from `text` and returns it: '\n', '\r' and "\r\n" end a line.
std::string_view take_natural_line(std::string_view& text) {
  const std::size_t end = text.find_first_of("\r\n");
  const std::string_view line = text.substr(0, end);
  if (end == std::string_view::npos) {
    text = {};
  } else {
    text.remove_prefix(end + (text.substr(end, 2) == "\r\n" ? 2 : 1));
  }
  return line;
}

std::string_view without_leading_blanks(std::string_view line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  return line;
}

bool is_continued(std::string_view line) {
  const std::size_t last = line.find_last_not_of('\\');
  const std::size_t backslashes = line.size() - (last == std::string_view::npos ? 0 : last + 1);
  return backslashes % 2 == 1;
}

// Removes a natural line and those that continue it; the result is empty for comments and empty lines.
std::string take_logical_line(std::string_view& text) {
  std::string_view line = without_leading_blanks(take_natural_line(text));
  if (line.starts_with('#') || line.starts_with('!')) return {};
  std::string result(line);
  while (is_continued(result)) {
    result.pop_back();
    result += without_leading_blanks(take_natural_line(text));
  }
  return result;
}

std::size_t key_end(std::string_view line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '\\') {
      ++i;
    } else if (line[i] == '=' || line[i] == ':' || kBlanks.find(line[i]) != std::string_view::npos) {
      return i;
    }
  }
  return line.size();
}

// The text after the key, without the one '=' or ':' and the blanks around it.
std::string_view value_of(std::string_view line, std::size_t end_of_key) {
  std::string_view value = without_leading_blanks(line.substr(end_of_key));
  if (value.starts_with('=') || value.starts_with(':')) value = without_leading_blanks(value.substr(1));
  return value;
}

// Removes the four digits after "\u" from `text`.
std::uint32_t take_code_unit(std::string_view& text) {
  const std::string_view digits = text.substr(0, 4);
  std::uint32_t code = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code, 16);
  if (digits.size() < 4 || error != std::errc() || end != digits.data() + 4) return kReplacement;
  text.remove_prefix(4);
  return code;
}

// A character beyond U+FFFF is written as a high and a low surrogate.
std::uint32_t take_code_point(std::string_view& text) {
  const std::uint32_t high = take_code_unit(text);
  if (high < 0xD800 || high > 0xDFFF) return high;
  if (high > 0xDBFF || !text.starts_with("\\u")) return kReplacement;
  std::string_view rest = text.substr(2);
  const std::uint32_t low = take_code_unit(rest);
  if (low < 0xDC00 || low > 0xDFFF) return kReplacement;
  text = rest;
  return 0x10000 + ((high - 0xD800) << 10) + (low - 0xDC00);
}

std::uint32_t take_escaped(std::string_view& text) {
  const char c = text.front();
  text.remove_prefix(1);
  switch (c) {
    case 'u': return take_code_point(text);
    case 't': return '\t';
    case 'n': return '\n';
    case 'r': return '\r';
    case 'f': return '\f';
    default: return static_cast<unsigned char>(c);
  }
}

std::string unescaped(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const char c = text.front();
    text.remove_prefix(1);
    const bool is_escape = c == '\\' && !text.empty();
    append_utf8(is_escape ? take_escaped(text) : static_cast<unsigned char>(c), result);
  }
  return result;
}

}  // namespace

std::map<std::string, std::string> parse_java_properties(std::span<const std::uint8_t> bytes) {
  std::map<std::string, std::string> properties;
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (!text.empty()) {
    const std::string line = take_logical_line(text);
    if (line.empty()) continue;
    const std::size_t end = key_end(line);
    properties[unescaped(std::string_view(line).substr(0, end))] = unescaped(value_of(line, end));
  }
  return properties;
}

}  // namespace lapis::simulator
