#include "evaluator/map_tools.hpp"

#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/mapping/file/map_file.hpp"
#include "common/report/report.hpp"
#include "evaluator/core/map/coverage.hpp"
#include "evaluator/core/map/iou.hpp"
#include "evaluator/core/map/map_input.hpp"
#include "evaluator/core/map/map_metrics.hpp"

namespace lapis::evaluator {
namespace {

using nlohmann::ordered_json;

struct MapOptions {
  std::string reference;
  std::string estimate;
  std::vector<std::uint16_t> top_classes;
  bool as_json = false;
};

struct LoadedMap {
  KnownSpace space;
  mapping::LabelList labels;
};

LoadedMap load(const std::string& path) {
  std::string error;
  const auto file = mapping::load_map(path, error);
  if (!file) throw std::runtime_error(error);
  return {to_known_space(file->map, mapping::BeliefReader(file->sensor_model)), file->labels};
}

template <class T>
ordered_json value_or_null(const std::optional<T>& value) {
  return value ? ordered_json(*value) : ordered_json(nullptr);
}

ordered_json describe(const MapOptions& options, const LoadedMap& reference, const LoadedMap& estimate) {
  return {{"reference", options.reference},
          {"estimate", options.estimate},
          {"resolution_m", estimate.space.occupied.resolution_m},
          {"reference_occupied_voxels", reference.space.occupied.voxels.size()},
          {"estimate_occupied_voxels", estimate.space.occupied.voxels.size()}};
}

// Throws unless every id means the same class in both files.
void require_same_classes(const MapOptions& options, const LoadedMap& reference, const LoadedMap& estimate) {
  for (const mapping::Label& label : reference.labels.labels()) {
    if (!estimate.labels.contains(label.id) || estimate.labels.name(label.id) == label.name) continue;
    throw std::runtime_error("class " + std::to_string(label.id) + " is '" + label.name + "' in " + options.reference +
                             " and '" + estimate.labels.name(label.id) + "' in " + options.estimate +
                             "; build both maps with one label list");
  }
}

void run_map(const MapOptions& options, std::ostream& out) {
  const LoadedMap reference = load(options.reference);
  const LoadedMap estimate = load(options.estimate);
  const MapError error = map_error(reference.space.occupied, estimate.space.occupied);
  ordered_json result = describe(options, reference, estimate);
  result["map_error_mean_m"] = value_or_null(error.accuracy_mean_m);
  result["map_error_p95_m"] = value_or_null(error.accuracy_p95_m);
  result["map_completeness_mean_m"] = value_or_null(error.completeness_mean_m);
  result["overlap"] = ordered_json::array();
  for (const Overlap& overlap : error.overlaps) {
    result["overlap"].push_back({{"tolerance_m", overlap.tolerance_m},
                                 {"precision", value_or_null(overlap.precision)},
                                 {"recall", value_or_null(overlap.recall)},
                                 {"f1", value_or_null(overlap.f1)}});
  }
  report::print(out, result, options.as_json);
}

void run_iou(const MapOptions& options, std::ostream& out) {
  const LoadedMap reference = load(options.reference);
  const LoadedMap estimate = load(options.estimate);
  require_same_classes(options, reference, estimate);
  const SemanticIou iou = semantic_iou(reference.space.occupied, estimate.space.occupied, options.top_classes);
  const CommonSpace common = restrict_to_common(reference.space, estimate.space);
  const SemanticIou observed = semantic_iou(common.reference, common.estimate, top_classes(iou));
  ordered_json result = describe(options, reference, estimate);
  result["iou_top8_mean"] = value_or_null(iou.top_mean);
  result["iou_mean"] = value_or_null(iou.mean);
  result["observed_in_both_share"] = value_or_null(common.share);
  result["observed_iou_top8_mean"] = value_or_null(observed.top_mean);
  result["observed_iou_mean"] = value_or_null(observed.mean);
  result["classes"] = ordered_json::array();
  for (const ClassIou& c : iou.classes) {
    result["classes"].push_back({{"id", c.label},
                                 {"class", reference.labels.name(c.label)},
                                 {"iou", c.iou},
                                 {"tolerant_iou", c.tolerant_iou},
                                 {"reference_voxels", c.reference_voxels},
                                 {"estimate_voxels", c.estimate_voxels},
                                 {"common_voxels", c.common_voxels},
                                 {"top8", c.is_top}});
  }
  report::print(out, result, options.as_json);
}

void run_coverage(const MapOptions& options, std::ostream& out) {
  const LoadedMap estimate = load(options.estimate);
  const Coverage figures =
      options.reference.empty() ? coverage(estimate.space) : coverage(load(options.reference).space, estimate.space);
  ordered_json result = {
      {"reference", options.reference.empty() ? ordered_json(nullptr) : ordered_json(options.reference)},
      {"estimate", options.estimate},
      {"resolution_m", estimate.space.occupied.resolution_m},
      {"explored_volume_m3", figures.explored_volume_m3},
      {"free_volume_m3", figures.free_volume_m3},
      {"occupied_volume_m3", figures.occupied_volume_m3},
      {"explored_share", value_or_null(figures.explored_share)}};
  report::print(out, result, options.as_json);
}

std::shared_ptr<MapOptions> add_options(CLI::App& tool, bool needs_reference) {
  auto options = std::make_shared<MapOptions>();
  tool.add_option("--reference", options->reference,
                  "reference map to compare with (.lapis file), with the same voxel grid")
      ->required(needs_reference);
  tool.add_option("--estimate", options->estimate, "map to judge (.lapis file)")->required();
  tool.add_flag("--json", options->as_json, "print JSON with all digits instead of text");
  return options;
}

}  // namespace

void add_map_tools(CLI::App& app, std::ostream& out) {
  CLI::App* map = app.add_subcommand("map", "map error: distances between the occupied voxels of two maps");
  const auto map_options = add_options(*map, true);
  map->footer(
      "The maps are compared as they are, without registration. Example:\n"
      "  lapis_evaluator map --reference run/reference_map.lapis --estimate run/map.lapis");
  map->callback([map_options, &out] { run_map(*map_options, out); });

  CLI::App* iou = app.add_subcommand("iou", "intersection over union (IoU) of two maps, for each class");
  const auto iou_options = add_options(*iou, true);
  iou->add_option("--top-classes", iou_options->top_classes,
                  "ids of the classes that iou_top8_mean averages, separated by commas; default: the 8 most frequent\n"
                  "classes of the reference")
      ->delimiter(',');
  iou->footer(
      "IoU counts the voxels that are occupied in either map; observed_iou_* counts only those that both maps have\n"
      "observed. Unlabelled voxels are no class. Example:\n"
      "  lapis_evaluator iou --reference run/reference_map.lapis --estimate run/map.lapis --json");
  iou->callback([iou_options, &out] { run_iou(*iou_options, out); });

  CLI::App* volume = app.add_subcommand(
      "coverage", "explored volume of a map, and with --reference the explored share of the reference's volume");
  const auto volume_options = add_options(*volume, false);
  volume->footer("Example:\n  lapis_evaluator coverage --estimate run/map.lapis");
  volume->callback([volume_options, &out] { run_coverage(*volume_options, out); });
}

}  // namespace lapis::evaluator
