#include "common/mapping/model/label_list.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lapis::mapping {
geometry::Rgb8 default_color(std::uint16_t id) {
  if (id == 0) return {127, 127, 127};
  // Steps of the golden ratio give consecutive ids distinct hues; four saturations and two values separate similar
  // hues.
  const double hue = std::fmod(id * 0.61803398874989485, 1.0) * 6.0;
  const double saturation = 0.55 + 0.15 * (id / 2 % 4);
  const double value = id % 2 == 0 ? 0.95 : 0.72;
  const auto channel = [&](double n) {  // HSV to RGB, channel n = 5, 3, 1
    const double k = std::fmod(n + hue, 6.0);
    return value - value * saturation * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0);
  };
  const auto byte = [](double v) { return static_cast<std::uint8_t>(std::lround(v * 255.0)); };
  return {byte(channel(5.0)), byte(channel(3.0)), byte(channel(1.0))};
}

LabelList::LabelList(std::vector<Label> labels) : labels_(std::move(labels)) {
  std::sort(labels_.begin(), labels_.end(), [](const Label& a, const Label& b) { return a.id < b.id; });
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    const std::uint16_t id = labels_[i].id;
    if (id == 0) throw std::runtime_error("label list: id 0 means unlabelled and cannot name a class");
    if (i > 0 && labels_[i - 1].id == id) throw std::runtime_error("label list: id " + std::to_string(id) + " twice");
  }
}

LabelList LabelList::from_names(const std::vector<std::pair<std::uint16_t, std::string>>& names) {
  std::vector<Label> labels;
  for (const auto& [id, name] : names) labels.push_back({id, name, default_color(id)});
  return LabelList(std::move(labels));
}

LabelList LabelList::united(const LabelList& a, const LabelList& b) {
  std::vector<Label> labels = a.labels_;
  for (const Label& label : b.labels_) {
    const Label* same_id = a.find(label.id);
    if (same_id == nullptr) {
      labels.push_back(label);
    } else if (same_id->name != label.name) {
      throw std::runtime_error("class " + std::to_string(label.id) + " is '" + same_id->name +
                               "' in one label list and '" + label.name + "' in the other");
    }
  }
  return LabelList(std::move(labels));
}

const Label* LabelList::find(std::uint16_t id) const {
  const auto it = std::lower_bound(labels_.begin(), labels_.end(), id,
                                   [](const Label& label, std::uint16_t wanted) { return label.id < wanted; });
  return it != labels_.end() && it->id == id ? &*it : nullptr;
}

std::string LabelList::name(std::uint16_t id) const {
  if (id == 0) return "unlabelled";
  const Label* label = find(id);
  return label ? label->name : "class " + std::to_string(id);
}

std::optional<std::uint16_t> LabelList::id_of(std::string_view name) const {
  const auto it = std::find_if(labels_.begin(), labels_.end(), [&](const Label& label) { return label.name == name; });
  if (it == labels_.end()) return std::nullopt;
  return it->id;
}

geometry::Rgb8 LabelList::color(std::uint16_t id) const {
  const Label* label = find(id);
  return label ? label->color : default_color(id);
}

}  // namespace lapis::mapping
