#include "segmenter/core/class_table.hpp"

namespace lapis::segmenter {

ClassTable::ClassTable(const std::map<int, std::uint16_t>& labels) {
  if (labels.empty()) return;
  labels_.resize(static_cast<std::size_t>(labels.rbegin()->first) + 1);
  for (const auto& [index, label] : labels) labels_[static_cast<std::size_t>(index)] = label;
}

}  // namespace lapis::segmenter
