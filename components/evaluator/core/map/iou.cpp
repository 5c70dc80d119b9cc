#include "evaluator/core/map/iou.hpp"

#include <algorithm>
#include <iterator>
#include <map>

namespace lapis::evaluator {
namespace {

struct Counts {
  std::size_t reference = 0;
  std::size_t estimate = 0;
  std::size_t common = 0;
  std::size_t matched_reference = 0;  // with a voxel of the same label in the estimate, at most one step away
  std::size_t matched_estimate = 0;
};
using CountsByLabel = std::map<std::uint16_t, Counts>;

const LabelledVoxel* find(const LabelledVoxels& map, const VoxelIndex& index) {
  const auto it =
      std::lower_bound(map.voxels.begin(), map.voxels.end(), index,
                       [](const LabelledVoxel& voxel, const VoxelIndex& i) { return is_before(voxel.index, i); });
  return it != map.voxels.end() && it->index == index ? &*it : nullptr;
}

bool has_label_at(const LabelledVoxels& map, const VoxelIndex& index, std::uint16_t label) {
  const LabelledVoxel* voxel = find(map, index);
  return voxel != nullptr && voxel->label == label;
}

bool has_label_near(const LabelledVoxels& map, const LabelledVoxel& voxel) {
  if (has_label_at(map, voxel.index, voxel.label)) return true;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (has_label_at(map, voxel.index + VoxelIndex(x, y, z), voxel.label)) return true;
      }
    }
  }
  return false;
}

bool is_observed(const KnownSpace& space, const VoxelIndex& index) {
  return find(space.occupied, index) != nullptr ||
         std::binary_search(space.free.begin(), space.free.end(), index, is_before);
}

LabelledVoxels observed_by(const KnownSpace& space, const LabelledVoxels& map) {
  LabelledVoxels result{map.resolution_m, {}};
  std::copy_if(map.voxels.begin(), map.voxels.end(), std::back_inserter(result.voxels),
               [&space](const LabelledVoxel& voxel) { return is_observed(space, voxel.index); });
  return result;
}

CountsByLabel count_labels(const LabelledVoxels& reference, const LabelledVoxels& estimate) {
  CountsByLabel counts;
  for (const LabelledVoxel& voxel : reference.voxels) {
    Counts& c = counts[voxel.label];
    ++c.reference;
    if (has_label_at(estimate, voxel.index, voxel.label)) ++c.common;
    if (has_label_near(estimate, voxel)) ++c.matched_reference;
  }
  for (const LabelledVoxel& voxel : estimate.voxels) {
    Counts& c = counts[voxel.label];
    ++c.estimate;
    if (has_label_near(reference, voxel)) ++c.matched_estimate;
  }
  counts.erase(0);
  return counts;
}

ClassIou class_iou(std::uint16_t label, const Counts& c) {
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
  };
  const std::size_t missed = c.reference - c.matched_reference;
  return {.label = label,
          .reference_voxels = c.reference,
          .estimate_voxels = c.estimate,
          .common_voxels = c.common,
          .iou = share(c.common, c.reference + c.estimate - c.common),
          .tolerant_iou = share(c.matched_estimate, c.estimate + missed)};
}

void mark_top(std::vector<ClassIou>& classes, const std::vector<std::uint16_t>& top_classes) {
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const bool is_frequent = i < kTopClasses && classes[i].reference_voxels > 0;
    const bool is_listed = std::find(top_classes.begin(), top_classes.end(), classes[i].label) != top_classes.end();
    classes[i].is_top = top_classes.empty() ? is_frequent : is_listed;
  }
}

template <class IsCounted>
std::optional<double> mean_iou(const std::vector<ClassIou>& classes, IsCounted is_counted) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const ClassIou& c : classes) {
    if (!is_counted(c)) continue;
    sum += c.iou;
    ++count;
  }
  return count == 0 ? std::nullopt : std::optional(sum / static_cast<double>(count));
}

}  // namespace

SemanticIou semantic_iou(const LabelledVoxels& reference, const LabelledVoxels& estimate,
                         const std::vector<std::uint16_t>& top_classes) {
  require_same_grid(reference, estimate);
  SemanticIou result;
  for (const auto& [label, counts] : count_labels(reference, estimate)) {
    result.classes.push_back(class_iou(label, counts));
  }
  // Stable: the map above is ordered by label, so ties go to the smaller id.
  std::stable_sort(result.classes.begin(), result.classes.end(),
                   [](const ClassIou& a, const ClassIou& b) { return a.reference_voxels > b.reference_voxels; });
  mark_top(result.classes, top_classes);
  const bool has_reference = !result.classes.empty() && result.classes.front().reference_voxels > 0;
  if (!has_reference) return result;
  result.top_mean = mean_iou(result.classes, [](const ClassIou& c) { return c.is_top; });
  result.mean = mean_iou(result.classes, [](const ClassIou&) { return true; });
  return result;
}

std::vector<std::uint16_t> top_classes(const SemanticIou& iou) {
  std::vector<std::uint16_t> labels;
  for (const ClassIou& c : iou.classes) {
    if (c.is_top) labels.push_back(c.label);
  }
  return labels;
}

CommonSpace restrict_to_common(const KnownSpace& reference, const KnownSpace& estimate) {
  require_same_grid(reference.occupied, estimate.occupied);
  CommonSpace common{observed_by(estimate, reference.occupied), observed_by(reference, estimate.occupied), {}};
  const std::size_t known_to_reference = reference.occupied.voxels.size() + reference.free.size();
  const std::size_t known_to_estimate = estimate.occupied.voxels.size() + estimate.free.size();
  std::size_t both = common.reference.voxels.size();
  for (const VoxelIndex& index : reference.free) both += is_observed(estimate, index) ? 1 : 0;
  const std::size_t either = known_to_reference + known_to_estimate - both;
  if (either > 0) common.share = static_cast<double>(both) / static_cast<double>(either);
  return common;
}

}  // namespace lapis::evaluator
