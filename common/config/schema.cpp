#include "common/config/schema.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

namespace lapis::config {
namespace {

/// Number of bytes of the UTF-8 character at the beginning of `text`; 0 when no valid character begins there.
std::size_t utf8_length(std::string_view text) {
  const auto byte = static_cast<unsigned char>(text.front());
  const std::size_t length = byte < 0x80 ? 1 : byte >> 5 == 6 ? 2 : byte >> 4 == 14 ? 3 : byte >> 3 == 30 ? 4 : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 0;
  }
  return length;
}

std::string hexadecimal_escape(char c) {
  static constexpr char kDigits[] = "0123456789abcdef";
  const auto byte = static_cast<unsigned char>(c);
  return {'\\', 'u', '0', '0', kDigits[byte >> 4], kDigits[byte & 15]};  // the escape is valid in YAML and in JSON
}

}  // namespace

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = utf8_length(text);
    if (length == 0 || text.front() == '\0') return false;
    text.remove_prefix(length);
  }
  return true;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (std::size_t i = 0; i < text.size();) {
    const char c = text[i];
    const std::size_t length = utf8_length(std::string_view(text).substr(i));
    if (c == '"' || c == '\\') {
      out += {'\\', c};
    } else if (c == '\n') {
      out += "\\n";
    } else if (length == 0 || (length == 1 && (c < ' ' || c == 0x7f))) {
      out += hexadecimal_escape(c);
    } else {
      out += text.substr(i, length);
    }
    i += std::max<std::size_t>(length, 1);
  }
  return out + '"';
}

namespace {

std::string number_text(double value) {
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

struct ValueText {
  std::string operator()(const bool* v) const { return *v ? "true" : "false"; }
  std::string operator()(const int* v) const { return std::to_string(*v); }
  std::string operator()(const std::int64_t* v) const { return std::to_string(*v); }
  std::string operator()(const double* v) const { return number_text(*v); }
  std::string operator()(const std::string* v) const { return quoted(*v); }
  std::string operator()(const Words* v) const {
    std::string out = "[";
    for (const auto& word : *v) out += (out.size() > 1 ? ", " : "") + quoted(word);
    return out + "]";
  }
  std::string operator()(const Numbers* v) const {
    std::string out = "[";
    for (const double number : *v) out += (out.size() > 1 ? ", " : "") + number_text(number);
    return out + "]";
  }
};

struct IsAllowed {
  const Bound& bound;

  bool operator()(const bool*) const { return true; }
  bool operator()(const int* v) const { return bound.allows(static_cast<double>(*v)); }
  bool operator()(const std::int64_t* v) const { return bound.allows(static_cast<double>(*v)); }
  bool operator()(const double* v) const { return bound.allows(*v); }
  bool operator()(const std::string* v) const { return bound.allows(*v); }
  template <class Item>
  bool operator()(const std::vector<Item>* v) const {
    return std::all_of(v->begin(), v->end(), [this](const Item& item) { return bound.allows(item); });
  }
};

}  // namespace

bool Bound::allows(const std::string& word) const {
  return words.empty() || std::find(words.begin(), words.end(), word) != words.end();
}

std::string Bound::refusal() const {
  return (words.empty() ? " is out of range, allowed is " : " is not one of ") + text();
}

std::string Bound::text() const {
  if (!words.empty()) {
    std::string out;
    for (const auto& word : words) out += (out.empty() ? "" : " | ") + word;
    return out;
  }
  if (std::isinf(lowest) && std::isinf(highest)) return "";
  if (std::isinf(highest)) return "at least " + number_text(lowest);
  return number_text(lowest) + " to " + number_text(highest);
}

Bound in_range(double lowest, double highest) { return {lowest, highest, {}, {}}; }
Bound at_least(double lowest) { return {lowest, std::numeric_limits<double>::infinity(), {}, {}}; }
Bound anything() { return {}; }
Bound one_of(Words words, std::string listed_in) {
  Bound bound;
  bound.words = std::move(words);
  bound.listed_in = std::move(listed_in);
  return bound;
}

void check(const Schema& schema) {
  for (const Entry& entry : schema.entries()) {
    if (std::visit(IsAllowed{entry.bound}, entry.value)) continue;
    throw Error(entry.path + ": " + to_text(entry) + entry.bound.refusal());
  }
}

std::string to_text(const Entry& entry) { return std::visit(ValueText{}, entry.value); }

std::string to_markdown(const Schema& schema) {
  std::ostringstream out;
  out << "| key | default | allowed | meaning |\n| --- | --- | --- | --- |\n";
  for (const auto& entry : schema.entries()) {
    std::string allowed = entry.bound.document();
    for (std::size_t at = 0; (at = allowed.find('|', at)) != std::string::npos; at += 2) allowed.insert(at, "\\");
    out << "| `" << entry.path << "` | `" << to_text(entry) << "` | " << allowed << " | " << entry.remark() << " |\n";
  }
  return out.str();
}

}  // namespace lapis::config
