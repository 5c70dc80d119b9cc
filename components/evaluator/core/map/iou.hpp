#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "evaluator/core/map/voxels.hpp"

namespace lapis::evaluator {

/// Number of classes by which a run is judged: the most frequent ones of the reference.
inline constexpr std::size_t kTopClasses = 8;

/// Intersection over union of one class, over the voxels occupied in either map.
struct ClassIou {
  std::uint16_t label = 0;
  std::size_t reference_voxels = 0;
  std::size_t estimate_voxels = 0;
  std::size_t common_voxels = 0;  ///< voxels that are occupied with this label in both maps
  double iou = 0.0;               ///< common / (reference + estimate - common)
  double tolerant_iou = 0.0;      ///< a voxel of the same label up to one step away (26 neighbours) counts as common
  bool is_top = false;            ///< among the classes of top_mean
};

struct SemanticIou {
  /// Every class present in either map, without 0 (unlabelled); most frequent in the reference first.
  std::vector<ClassIou> classes;
  std::optional<double> top_mean;  ///< unweighted mean over the top classes
  std::optional<double> mean;      ///< unweighted mean over all classes present in either map
};

/// Throws std::invalid_argument when the resolutions differ. Means are missing when the reference has no class.
/// `top_classes` sets the classes of top_mean (a scene's own list); empty = the kTopClasses most frequent classes of
/// the reference, where ties go to the smaller id.
SemanticIou semantic_iou(const LabelledVoxels& reference, const LabelledVoxels& estimate,
                         const std::vector<std::uint16_t>& top_classes = {});

/// Labels of the classes in top_mean.
std::vector<std::uint16_t> top_classes(const SemanticIou& iou);

/// Two maps reduced to the voxels that both have observed, free or occupied.
struct CommonSpace {
  LabelledVoxels reference;
  LabelledVoxels estimate;
  /// Share of these voxels in those that at least one map has observed; none when both maps are empty.
  std::optional<double> share;
};

/// Throws std::invalid_argument when the resolutions differ.
CommonSpace restrict_to_common(const KnownSpace& reference, const KnownSpace& estimate);

}  // namespace lapis::evaluator
