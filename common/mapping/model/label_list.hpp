#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/geometry/image.hpp"

namespace lapis::mapping {

struct Label {
  std::uint16_t id = 0;
  std::string name;
  geometry::Rgb8 color;
  bool operator==(const Label&) const = default;
};

/// Colour of a class without a colour of its own: deterministic, distinct for ids up to 255, and neighbouring ids
/// differ in hue. 0 (unlabelled) is grey.
geometry::Rgb8 default_color(std::uint16_t id);

/// The classes of a label image: ids 1..65535 with name and colour; 0 is always "unlabelled".
class LabelList {
 public:
  LabelList() = default;
  /// Throws std::runtime_error when an id is 0 or occurs twice.
  explicit LabelList(std::vector<Label> labels);
  /// A list of classes with default colours.
  static LabelList from_names(const std::vector<std::pair<std::uint16_t, std::string>>& names);

  /// The classes of both. Throws std::runtime_error when an id has two names.
  static LabelList united(const LabelList& a, const LabelList& b);

  const std::vector<Label>& labels() const { return labels_; }  ///< sorted by id
  std::size_t size() const { return labels_.size(); }
  /// Largest id; 0 for an empty list.
  std::uint16_t max_id() const { return labels_.empty() ? std::uint16_t{0} : labels_.back().id; }
  /// Largest id that a label image may hold: with an empty list every id is accepted.
  std::uint16_t largest_accepted_id() const { return labels_.empty() ? std::uint16_t{65535} : max_id(); }
  bool contains(std::uint16_t id) const { return find(id) != nullptr; }
  /// "unlabelled" for 0, "class <id>" for an id that is not listed.
  std::string name(std::uint16_t id) const;
  /// Id of the class with this name, the smallest id if there are several; nothing when there is none.
  std::optional<std::uint16_t> id_of(std::string_view name) const;
  /// The default colour for an id that is not listed.
  geometry::Rgb8 color(std::uint16_t id) const;
  bool operator==(const LabelList&) const = default;

 private:
  const Label* find(std::uint16_t id) const;
  std::vector<Label> labels_;
};

}  // namespace lapis::mapping
