#include "common/config/yaml_entry.hpp"

#include <charconv>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace lapis::config {
namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const YAML::Mark& mark, const std::string& why) {
  // Marks of unreadable files are null (line -1).
  const std::string line = mark.line >= 0 ? ":" + std::to_string(mark.line + 1) : "";
  throw std::runtime_error(file.string() + line + ": " + why);
}

/// The number that the whole word stands for; a leading '+' is allowed.
std::optional<double> number_of(std::string_view word) {
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace

YAML::Node load_yaml(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw std::runtime_error(file.string() + ": not found");
  if (!std::filesystem::is_regular_file(file)) throw std::runtime_error(file.string() + ": is not a file");
  try {
    return YAML::LoadFile(file.string());
  } catch (const YAML::Exception& error) {
    fail(file, error.mark, "not valid YAML: " + error.msg);
  }
}

YamlEntry::YamlEntry(std::filesystem::path file, const YAML::Node& node, std::string what)
    : file_(std::move(file)), node_(node), what_(std::move(what)) {
  if (!node_.IsMap()) refuse("must be a list of \"key: value\"");
  std::set<std::string> seen;
  for (const auto& pair : node_) {
    if (!pair.first.IsScalar()) refuse_at(pair.first, "keys must be words");
    const std::string name = pair.first.Scalar();
    if (!seen.insert(name).second) refuse_at(pair.first, "key \"" + name + "\" occurs twice");
  }
}

YAML::Node YamlEntry::node(const std::string& key) {
  asked_.insert(key);
  const YAML::Node& entries = node_;  // operator[] of a constant node adds nothing
  return entries[key];
}

YAML::Node YamlEntry::required(const std::string& key) {
  YAML::Node value = node(key);
  if (!value.IsDefined()) refuse("key \"" + key + "\" is missing");
  return value;
}

bool YamlEntry::has(const std::string& key) { return node(key).IsDefined(); }

double YamlEntry::to_number(const YAML::Node& value, const std::string& key) const {
  constexpr double kLargest = 1e9;
  if (value.IsScalar()) {
    const auto number = number_of(value.Scalar());
    if (number && std::abs(*number) <= kLargest) return *number;
  }
  refuse_at(value, key + ": must be a number" + (value.IsScalar() ? ", not \"" + value.Scalar() + "\"" : ""));
}

std::vector<double> YamlEntry::to_numbers(const YAML::Node& value, const std::string& key, std::size_t count) const {
  if (!value.IsSequence() || value.size() != count)
    refuse_at(value, key + ": must be " + std::to_string(count) + " numbers [a, b, ...]");
  std::vector<double> numbers;
  for (const auto& element : value) numbers.push_back(to_number(element, key));
  return numbers;
}

double YamlEntry::number(const std::string& key) { return to_number(required(key), key); }

double YamlEntry::number(const std::string& key, double otherwise) { return has(key) ? number(key) : otherwise; }

int YamlEntry::whole_number(const std::string& key, int otherwise) {
  if (!has(key)) return otherwise;
  const double value = number(key);
  if (value != std::floor(value) || std::abs(value) > 1e9) refuse_at(node(key), key + ": must be a whole number");
  return static_cast<int>(value);
}

bool YamlEntry::flag(const std::string& key, bool otherwise) {
  if (!has(key)) return otherwise;
  const std::string value = text(key);
  if (value != "true" && value != "false") refuse_at(node(key), key + ": must be true or false");
  return value == "true";
}

std::string YamlEntry::text(const std::string& key) {
  const YAML::Node value = required(key);
  if (!value.IsScalar() || value.Scalar().empty()) refuse_at(value, key + ": must be a word");
  return value.Scalar();
}

std::string YamlEntry::text(const std::string& key, const std::string& otherwise) {
  return has(key) ? text(key) : otherwise;
}

std::vector<double> YamlEntry::numbers(const std::string& key, std::size_t count) {
  return to_numbers(required(key), key, count);
}

std::vector<std::vector<double>> YamlEntry::points(const std::string& key) {
  const YAML::Node value = required(key);
  if (!value.IsSequence()) refuse_at(value, key + ": must be points [[x, y], ...]");
  std::vector<std::vector<double>> points;
  for (const auto& point : value) points.push_back(to_numbers(point, key, 2));
  return points;
}

YamlEntry YamlEntry::entry(const std::string& key) { return {file_, required(key), key}; }

std::vector<YamlEntry> YamlEntry::entries(const std::string& key, const std::string& what) {
  std::vector<YamlEntry> result;
  if (!has(key)) return result;
  const YAML::Node list = node(key);
  if (!list.IsSequence()) refuse_at(list, key + ": must be a list");
  for (const auto& element : list) result.emplace_back(file_, element, what);
  return result;
}

std::vector<std::pair<std::string, std::string>> YamlEntry::all_texts() {
  std::vector<std::pair<std::string, std::string>> result;
  for (const auto& pair : node_) result.emplace_back(pair.first.Scalar(), text(pair.first.Scalar()));
  return result;
}

bool YamlEntry::is_number(const std::string& key) {
  const YAML::Node value = node(key);
  return value.IsDefined() && value.IsScalar() && value.Scalar().find_first_not_of("0123456789") == std::string::npos;
}

void YamlEntry::done() const {
  for (const auto& pair : node_) {
    if (!asked_.contains(pair.first.Scalar())) refuse_unknown(pair.first);
  }
}

void YamlEntry::refuse_unknown(const YAML::Node& key) const {
  std::string known;
  for (const auto& name : asked_) known.append(known.empty() ? "" : ", ").append(name);
  refuse_at(key, what_ + ": unknown key \"" + key.Scalar() + "\"; known are " + known);
}

void YamlEntry::refuse(const std::string& why) const { refuse_at(node_, what_ + ": " + why); }

void YamlEntry::refuse_at(const YAML::Node& at, const std::string& why) const {
  fail(file_, at.IsDefined() ? at.Mark() : node_.Mark(), why);
}

}  // namespace lapis::config
