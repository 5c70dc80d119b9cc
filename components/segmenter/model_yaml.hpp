#pragma once

#include <filesystem>

#include "common/mapping/model/label_list.hpp"
#include "segmenter/core/model.hpp"

namespace lapis::segmenter {

/// A network with the classes that it is used for.
struct ModelFile {
  Model model;
  mapping::LabelList labels;
};

/// Reads a model file (components/segmenter/README.md) and the label list that it names.
/// @throws std::runtime_error naming file, line, key and remedy
ModelFile read_model_file(const std::filesystem::path& file);

}  // namespace lapis::segmenter
