#pragma once

#include <filesystem>

#include "common/mapping/model/label_list.hpp"

namespace lapis::config {
class YamlEntry;
}

namespace lapis::mapping {

/// Reads a list of classes: "labels: [{id: 1, name: wall, color: [r, g, b]}, ...]"; the colour may be left out.
/// @throws std::runtime_error naming file and line
LabelList read_label_list(const std::filesystem::path& file);

/// The value of the key `color`: [r, g, b], each from 0 to 255.
/// @throws std::runtime_error naming file and line
geometry::Rgb8 read_color(config::YamlEntry& entry);

}  // namespace lapis::mapping
