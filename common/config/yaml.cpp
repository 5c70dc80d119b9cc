#include "common/config/yaml.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <set>
#include <sstream>

namespace lapis::config {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 16u << 20;

[[noreturn]] void fail(const std::string& source, const std::string& path, const std::string& problem) {
  throw Error(source + ": " + (path.empty() ? "" : path + ": ") + problem);
}

std::string place(const std::string& source, const YAML::Node& node) {
  return node.Mark().is_null() ? source : source + ":" + std::to_string(node.Mark().line + 1);
}

/// Checks and stores one scalar or list; std::visit passes the pointer to the target.
struct Store {
  const Entry& entry;
  const YAML::Node& node;
  const std::string& source;

  void operator()(bool* target) const { *target = scalar<bool>(node, "true or false"); }
  void operator()(int* target) const { *target = bounded<int>(node, "a whole number"); }
  void operator()(std::int64_t* target) const { *target = bounded<std::int64_t>(node, "a whole number"); }
  void operator()(double* target) const { *target = bounded<double>(node, "a number"); }
  void operator()(std::string* target) const { *target = word(node); }
  void operator()(Words* target) const {
    if (!node.IsSequence()) reject("a list such as [a, b] is needed");
    Words words;
    for (const auto& item : node) words.push_back(word(item));
    *target = std::move(words);
  }
  void operator()(Numbers* target) const {
    if (!node.IsSequence()) reject("a list such as [1, 2] is needed");
    Numbers numbers;
    for (const auto& item : node) numbers.push_back(bounded<double>(item, "a number"));
    *target = std::move(numbers);
  }

 private:
  [[noreturn]] void reject(const std::string& problem) const { fail(place(source, node), entry.path, problem); }

  static std::string shown(const YAML::Node& item) {
    return item.IsScalar() ? "'" + item.Scalar() + "'" : "this value";
  }

  template <class T>
  T scalar(const YAML::Node& item, const std::string& wanted) const {
    T value{};
    if (!item.IsScalar() || !YAML::convert<T>::decode(item, value)) reject(shown(item) + " is not " + wanted);
    return value;
  }

  template <class T>
  T bounded(const YAML::Node& item, const std::string& wanted) const {
    const T value = scalar<T>(item, wanted);
    if (!entry.bound.allows(static_cast<double>(value))) reject(shown(item) + entry.bound.refusal());
    return value;
  }

  std::string word(const YAML::Node& item) const {
    if (!item.IsScalar()) reject("text is needed");
    if (!entry.bound.allows(item.Scalar())) reject(shown(item) + entry.bound.refusal());
    return item.Scalar();
  }
};

bool is_section(const Schema& schema, const std::string& path) {
  const std::string prefix = path + ".";
  return std::any_of(schema.entries().begin(), schema.entries().end(),
                     [&](const Entry& entry) { return entry.path.compare(0, prefix.size(), prefix) == 0; });
}

const Entry* find(const Schema& schema, const std::string& path) {
  const auto& entries = schema.entries();
  const auto it = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.path == path; });
  return it == entries.end() ? nullptr : &*it;
}

/// The known key that resembles a mistyped one most: the key with the longest common prefix.
std::string nearest_key(const Schema& schema, const std::string& path) {
  std::string best;
  std::size_t best_length = 0;
  for (const auto& entry : schema.entries()) {
    const auto [a, b] = std::mismatch(path.begin(), path.end(), entry.path.begin(), entry.path.end());
    const auto length = static_cast<std::size_t>(a - path.begin());
    if (length > best_length) {
      best_length = length;
      best = entry.path;
    }
  }
  return best.empty() ? "" : " (did you mean '" + best + "'?)";
}

/// What became of an old key, worded for the key that was given, which may be in a section that moved as a whole.
std::optional<std::string> whereabouts(const Schema& schema, const std::string& path) {
  for (const auto& former : schema.former()) {
    const bool is_inside = path.compare(0, former.path.size() + 1, former.path + ".") == 0;
    if (path != former.path && !is_inside) continue;
    const std::string now =
        former.now.empty() ? "is gone" : "is now '" + former.now + path.substr(former.path.size()) + "'";
    return now + (former.remark.empty() ? "" : ": " + former.remark);
  }
  return std::nullopt;
}

[[noreturn]] void refuse_key(const Schema& schema, const std::string& path, const std::string& source) {
  if (const auto now = whereabouts(schema, path)) fail(source, path, *now);
  fail(source, path, "unknown key" + nearest_key(schema, path) + "; --print-config lists all keys");
}

void apply_node(const Schema& schema, const YAML::Node& node, const std::string& path, const std::string& source) {
  if (const Entry* entry = find(schema, path)) {
    std::visit(Store{*entry, node, source}, entry->value);
    return;
  }
  if (!path.empty() && !is_section(schema, path)) refuse_key(schema, path, place(source, node));
  if (node.IsNull()) return;
  if (!node.IsMap()) fail(place(source, node), path, "a section with keys is needed");
  std::set<std::string> seen;
  for (const auto& item : node) {
    const std::string key = item.first.Scalar();
    std::string full = path.empty() ? "" : path + ".";
    full += key;
    if (!seen.insert(key).second) fail(place(source, item.first), full, "key appears twice");
    apply_node(schema, item.second, full, source);
  }
}

YAML::Node parse(const std::string& text, const std::string& source) {
  try {
    const auto documents = YAML::LoadAll(text);
    if (documents.size() > 1) throw Error(source + ": holds more than one YAML document");
    return documents.empty() ? YAML::Node() : documents.front();
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw Error(source + line + ": not valid YAML: " + error.msg);
  }
}

/// The text, with the current value inserted after each key that it names.
std::string with_values(const Schema& schema, const std::string& text) {
  std::istringstream words(text);
  std::string out;
  for (std::string word; words >> word;) {
    const std::size_t end = word.find_last_not_of(',') + 1;
    if (const Entry* entry = find(schema, word.substr(0, end))) word.insert(end, " (" + to_text(*entry) + ")");
    out += (out.empty() ? "" : " ") + word;
  }
  return out;
}

}  // namespace

void apply_text(const Schema& schema, const std::string& text, const std::string& source) {
  apply_node(schema, parse(text, source), "", source);
}

std::string read_text(const std::string& file) {
  std::error_code error;
  const bool is_file = std::filesystem::is_regular_file(file, error);  // opening a pipe would wait for its other end
  std::ifstream in;
  if (is_file) in.open(file);
  if (!in.is_open()) throw Error(file + ": cannot be read; give --config the path of an existing YAML file");
  if (std::filesystem::file_size(file) > kMaxFileBytes) throw Error(file + ": is larger than 16 MiB");
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!is_utf8(text)) throw Error(file + ": is not UTF-8 text");
  return text;
}

void apply_file(const Schema& schema, const std::string& file) { apply_text(schema, read_text(file), file); }

void apply_override(const Schema& schema, const std::string& assignment) {
  const std::string source = "--set " + assignment;
  const auto equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0) throw Error(source + ": write it as path=value");
  const std::string path = assignment.substr(0, equals);
  const Entry* entry = find(schema, path);
  if (entry == nullptr) refuse_key(schema, path, source);
  const std::string value = assignment.substr(equals + 1);
  const bool is_text = std::holds_alternative<std::string*>(entry->value);
  const YAML::Node node = is_text ? YAML::Node(value) : parse(value, source);
  std::visit(Store{*entry, node, source}, entry->value);
}

void check(const Schema& schema, const Rules& rules) {
  for (const auto& rule : rules) {
    if (!rule.holds) throw Error(with_values(schema, rule.text));
  }
}

std::string to_yaml(const Schema& schema) {
  std::ostringstream out;
  std::vector<std::string> open;  // sections that the previous entry was in
  for (const auto& entry : schema.entries()) {
    std::vector<std::string> parts;
    std::istringstream path(entry.path);
    for (std::string part; std::getline(path, part, '.');) parts.push_back(part);
    std::size_t depth = 0;
    while (depth < open.size() && depth + 1 < parts.size() && open[depth] == parts[depth]) ++depth;
    for (; depth + 1 < parts.size(); ++depth) out << std::string(2 * depth, ' ') << parts[depth] << ":\n";
    open.assign(parts.begin(), parts.end() - 1);
    const std::string indent(2 * (parts.size() - 1), ' ');
    const std::string allowed = entry.bound.document();
    out << indent << "# " << entry.remark() << (allowed.empty() ? "" : " [" + allowed + "]") << '\n';
    out << indent << parts.back() << ": " << to_text(entry) << '\n';
  }
  return out.str();
}

}  // namespace lapis::config
