#include "segmenter/model_yaml.hpp"

#include <algorithm>
#include <map>
#include <string>

#include "common/config/yaml_entry.hpp"
#include "common/mapping/file/label_list_file.hpp"

namespace lapis::segmenter {
namespace {

using config::YamlEntry;

constexpr int kLargestSide = 4096;   // [px]
constexpr int kMostClasses = 65535;  // of a network

/// The value of a key with few allowed words, the first of which is the default.
template <class Value>
Value word(YamlEntry& entry, const std::string& key, const std::vector<std::pair<std::string, Value>>& allowed) {
  const std::string given = entry.text(key, allowed.front().first);
  std::string known;
  for (const auto& [name, value] : allowed) {
    if (given == name) return value;
    known += (known.empty() ? "" : ", ") + name;
  }
  entry.refuse(key + ": must be one of " + known + ", not \"" + given + "\"");
}

Layout layout(YamlEntry& entry) {
  return word<Layout>(entry, "layout", {{"NCHW", Layout::kNchw}, {"NHWC", Layout::kNhwc}});
}

int side(YamlEntry& entry, const std::string& key) {
  const int value = entry.whole_number(key, 0);
  if (value < 1 || value > kLargestSide) {
    entry.refuse(key + ": must be the network's " + key + " in pixels, from 1 to " + std::to_string(kLargestSide));
  }
  return value;
}

std::array<double, 3> per_channel(YamlEntry& entry, const std::string& key, const std::array<double, 3>& otherwise) {
  if (!entry.has(key)) return otherwise;
  const auto values = entry.numbers(key, 3);
  return {values[0], values[1], values[2]};
}

InputFormat input(YamlEntry entry) {
  InputFormat format;
  format.width = side(entry, "width");
  format.height = side(entry, "height");
  format.layout = layout(entry);
  format.channels = word<Channels>(entry, "channels", {{"rgb", Channels::kRgb}, {"bgr", Channels::kBgr}});
  format.scale = entry.number("scale", format.scale);
  format.mean = per_channel(entry, "mean", format.mean);
  format.std = per_channel(entry, "std", format.std);
  entry.done();
  if (std::any_of(format.std.begin(), format.std.end(), [](double value) { return value <= 0.0; })) {
    entry.refuse("std: must be three numbers above 0");
  }
  return format;
}

OutputFormat output(YamlEntry entry) {
  OutputFormat format;
  format.name = entry.text("name", "");
  format.layout = layout(entry);
  format.values = word<Values>(
      entry, "values",
      {{"logits", Values::kLogits}, {"probabilities", Values::kProbabilities}, {"labels", Values::kLabels}});
  entry.done();
  return format;
}

int class_index(const YamlEntry& entry, const std::string& key) {
  constexpr std::size_t kMostDigits = 5;
  const bool is_number = key.find_first_not_of("0123456789") == std::string::npos && key.size() <= kMostDigits;
  if (!is_number || std::stoi(key) >= kMostClasses) {
    entry.refuse("\"" + key + "\" is no index of a class of the network, which begin with 0");
  }
  return std::stoi(key);
}

/// "INDEX: NAME" for each class of the network that has a label.
ClassTable classes(YamlEntry entry, const mapping::LabelList& labels, const std::filesystem::path& label_file) {
  std::map<int, std::uint16_t> table;
  for (const auto& [key, name] : entry.all_texts()) {
    const auto label = labels.id_of(name);
    if (!label) entry.refuse(key + ": " + label_file.string() + " has no class \"" + name + "\"");
    if (!table.emplace(class_index(entry, key), *label).second) entry.refuse(key + ": the same index twice");
  }
  if (table.empty())
    entry.refuse("names no class: give \"INDEX: NAME\" for each class of the network that has a label");
  return ClassTable(table);
}

}  // namespace

ModelFile read_model_file(const std::filesystem::path& file) {
  YamlEntry root(file, config::load_yaml(file), "model");
  const auto folder = file.parent_path();
  ModelFile result;
  result.model.network = folder / root.text("network");
  const auto label_file = folder / root.text("labels");
  result.labels = mapping::read_label_list(label_file);
  result.model.input = input(root.entry("input"));
  if (root.has("output")) result.model.output = output(root.entry("output"));
  result.model.classes = classes(root.entry("classes"), result.labels, label_file);
  root.done();
  return result;
}

}  // namespace lapis::segmenter
