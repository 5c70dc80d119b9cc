#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace lapis::segmenter {

/// Labels (class ids of the label list) of a network's classes.
class ClassTable {
 public:
  ClassTable() = default;
  /// @param labels label by index of the network's class, at least 0
  explicit ClassTable(const std::map<int, std::uint16_t>& labels);

  /// Label of a class; 0 (unlabelled) for one that the table does not name.
  std::uint16_t label_of(std::size_t index) const { return index < labels_.size() ? labels_[index] : std::uint16_t{0}; }
  /// The largest index that it names, and one more.
  std::size_t size() const { return labels_.size(); }
  bool operator==(const ClassTable&) const = default;

 private:
  std::vector<std::uint16_t> labels_;  // by index
};

}  // namespace lapis::segmenter
