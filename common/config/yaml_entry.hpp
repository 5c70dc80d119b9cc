#pragma once

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace lapis::config {

/// Loads a YAML file. @throws std::runtime_error naming file and line
YAML::Node load_yaml(const std::filesystem::path& file);

/// A map of a YAML file that is read key by key; done() refuses keys that were never read. All errors are
/// std::runtime_error and name file and line.
class YamlEntry {
 public:
  YamlEntry(std::filesystem::path file, const YAML::Node& node, std::string what);

  bool has(const std::string& key);
  double number(const std::string& key, double otherwise);
  double number(const std::string& key);
  int whole_number(const std::string& key, int otherwise);
  bool flag(const std::string& key, bool otherwise);
  std::string text(const std::string& key, const std::string& otherwise);
  std::string text(const std::string& key);
  /// Exactly `count` numbers.
  std::vector<double> numbers(const std::string& key, std::size_t count);
  /// Points [[x, y], ...].
  std::vector<std::vector<double>> points(const std::string& key);
  YamlEntry entry(const std::string& key);
  /// A list of maps; empty when there is none.
  std::vector<YamlEntry> entries(const std::string& key, const std::string& what);
  bool is_map(const std::string& key) { return node(key).IsMap(); }
  /// All keys with their texts, of a map that has no fixed keys.
  std::vector<std::pair<std::string, std::string>> all_texts();
  bool is_number(const std::string& key);

  void done() const;
  [[noreturn]] void refuse(const std::string& why) const;

 private:
  YAML::Node node(const std::string& key);
  YAML::Node required(const std::string& key);
  double to_number(const YAML::Node& value, const std::string& key) const;
  std::vector<double> to_numbers(const YAML::Node& value, const std::string& key, std::size_t count) const;
  [[noreturn]] void refuse_unknown(const YAML::Node& key) const;
  [[noreturn]] void refuse_at(const YAML::Node& at, const std::string& why) const;

  std::filesystem::path file_;
  YAML::Node node_;
  std::string what_;
  std::set<std::string> asked_;
};

}  // namespace lapis::config
