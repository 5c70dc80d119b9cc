#include "common/mapping/file/label_list_file.hpp"

#include <array>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/config/yaml_entry.hpp"

namespace lapis::mapping {

geometry::Rgb8 read_color(config::YamlEntry& entry) {
  std::array<std::uint8_t, 3> channels{};
  const auto values = entry.numbers("color", 3);
  for (std::size_t i = 0; i < 3; ++i) {
    if (!(values[i] >= 0.0 && values[i] <= 255.0)) entry.refuse("color must be three numbers from 0 to 255");
    channels[i] = static_cast<std::uint8_t>(values[i]);
  }
  return {channels[0], channels[1], channels[2]};
}

LabelList read_label_list(const std::filesystem::path& file) {
  config::YamlEntry root(file, config::load_yaml(file), "label list");
  std::vector<Label> labels;
  for (auto& entry : root.entries("labels", "label")) {
    const int id = entry.whole_number("id", 0);
    if (id < 1 || id > 65535) entry.refuse("id must be a whole number from 1 to 65535");
    const auto number = static_cast<std::uint16_t>(id);
    labels.push_back({number, entry.text("name"), entry.has("color") ? read_color(entry) : default_color(number)});
    entry.done();
  }
  root.done();
  if (labels.empty()) root.refuse("it lists no labels");
  try {
    return LabelList(std::move(labels));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(file.string() + ": " + error.what());
  }
}

}  // namespace lapis::mapping
