#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "simulator/core/assets/asset_store.hpp"
#include "simulator/core/loaders/load_options.hpp"
#include "simulator/core/scene/scene.hpp"

/// What the loaders of users' own scenes share.
namespace lapis::simulator {

/// Store and name, for messages.
std::string full_name(const AssetStore& store, const std::string& name);

/// Content of a file. @throws std::runtime_error with the remedy when it is missing or empty.
std::vector<std::uint8_t> read_required(const AssetStore& store, const std::string& name);

/// Classes numbered from 1 in the order of their names.
mapping::LabelList number_classes(const std::set<std::string>& names);

/// The classes that a data set names, as ids of a scene's labels.
class ClassNames {
 public:
  /// With an empty list, all `names` become the labels.
  ClassNames(const mapping::LabelList& wanted, const std::set<std::string>& names);
  const mapping::LabelList& labels() const { return labels_; }
  /// 0 for names that say that there is no class ("", "void", "unlabeled", "unlabelled"), and for names that the list
  /// has not; those are remembered for the warning.
  std::uint16_t id_of(const std::string& name);
  /// One line about the names that the list has not; nothing when there are none.
  std::optional<std::string> warning() const;

 private:
  mapping::LabelList labels_;
  std::set<std::string> unknown_;
};

/// The instances of a scene while it is being read.
class InstanceList {
 public:
  /// `file` is for messages.
  explicit InstanceList(std::string file) : file_(std::move(file)) {}
  /// Adds an instance and returns its index. @throws std::runtime_error when the id is not in 1..65535 or is taken.
  std::uint32_t add(std::int64_t id, std::uint16_t class_id, std::string name);
  /// The same with the lowest free id; call it after all that have their own.
  std::uint32_t add_with_free_id(std::uint16_t class_id, std::string name);
  /// Index of the instance that holds what has no label; added when first needed, as by add_with_free_id().
  std::uint32_t unlabelled();
  const Instance& operator[](std::uint32_t index) const { return instances_[index]; }
  std::vector<Instance> take() { return std::move(instances_); }

 private:
  std::string file_;
  std::vector<Instance> instances_;
  std::set<std::uint16_t> ids_;
  std::uint32_t lowest_free_ = 1;
  std::optional<std::uint32_t> unlabelled_;
};

/// From y up to z up.
void turn_upright(Mesh& mesh);

/// What every loader does last: drops triangles with a vertex that is not finite or farther than 100 km from the
/// origin (with one warning), sets texture coordinates of that kind to zero, and finds floor_z_m: the lowest height at
/// which there is a fifth of the floor (class "floor"); without such a class the lowest point, with a warning.
/// @throws std::runtime_error naming `file` when no triangle is left.
void finish_scene(Scene& scene, const std::string& file);

}  // namespace lapis::simulator
