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

/// Functions that the loaders of users' own scenes share.
namespace lapis::simulator {

/// Name of a file together with its store, for messages.
std::string full_name(const AssetStore& store, const std::string& name);

/// Content of a file. @throws std::runtime_error naming the remedy when it is missing or empty.
std::vector<std::uint8_t> read_required(const AssetStore& store, const std::string& name);

/// Classes numbered from 1 in the order of their names.
mapping::LabelList number_classes(const std::set<std::string>& names);

/// Translates the class names of a data set into ids of a scene's labels.
class ClassNames {
 public:
  /// When `wanted` is empty, all `names` become the labels.
  ClassNames(const mapping::LabelList& wanted, const std::set<std::string>& names);
  const mapping::LabelList& labels() const { return labels_; }
  /// Id of a class; 0 for names that mean "no class" ("", "void", "unlabeled", "unlabelled"), and for names that are
  /// not in the list, which warning() reports.
  std::uint16_t id_of(const std::string& name);
  /// One line about names that were not in the list; nothing when there were none.
  std::optional<std::string> warning() const;

 private:
  mapping::LabelList labels_;
  std::set<std::string> unknown_;
};

/// The instances of a scene while it is being read.
class InstanceList {
 public:
  /// `file` is the name that messages show.
  explicit InstanceList(std::string file) : file_(std::move(file)) {}
  /// Adds an instance and returns its index. @throws std::runtime_error when the id is not in 1..65535 or is taken.
  std::uint32_t add(std::int64_t id, std::uint16_t class_id, std::string name);
  /// The same with the lowest free id; to be called after all instances with ids of their own have been added.
  std::uint32_t add_with_free_id(std::uint16_t class_id, std::string name);
  /// Index of the instance of everything without a label; it is added when first needed, as by add_with_free_id().
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

/// Rotates a mesh from y up to z up.
void turn_upright(Mesh& mesh);

/// The last step of every loader: drops triangles with a vertex that is not finite or farther than 100 km from the
/// origin (with one warning), sets texture coordinates that are not finite or beyond 10,000 to zero, and finds
/// floor_z_m: the lowest height at which there is a fifth of the level floor (class "floor"); failing that, the lowest
/// point, with a warning.
/// @throws std::runtime_error naming `file` when no triangle is left.
void finish_scene(Scene& scene, const std::string& file);

}  // namespace lapis::simulator
