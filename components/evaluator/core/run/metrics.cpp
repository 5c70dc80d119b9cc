#include "evaluator/core/run/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "evaluator/core/trajectory/ate.hpp"
#include "evaluator/core/trajectory/rpe.hpp"

namespace lapis::evaluator {
namespace {

using nlohmann::ordered_json;

template <class T>
ordered_json value_or_null(const std::optional<T>& value) {
  if (!value) return nullptr;
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(*value)) return nullptr;
  }
  return *value;
}

std::optional<double> position_rmse(const std::vector<Match>& matches, Alignment alignment) {
  const auto error = absolute_error(matches, alignment);
  return error ? std::optional(error->position_m.rmse) : std::nullopt;
}

ordered_json by_class(const std::vector<NamedClassIou>& classes) {
  if (classes.empty()) return nullptr;
  ordered_json result = ordered_json::object();
  for (const NamedClassIou& c : classes) {
    const std::string key = result.contains(c.name) ? c.name + " (" + std::to_string(c.figures.label) + ")" : c.name;
    result[key] = {{"iou", c.figures.iou},
                   {"tolerant_iou", c.figures.tolerant_iou},
                   {"reference_voxels", c.figures.reference_voxels},
                   {"estimate_voxels", c.figures.estimate_voxels},
                   {"top8", c.figures.is_top}};
  }
  return result;
}

ordered_json by_process(const std::map<std::string, std::optional<double>>& values) {
  if (values.empty()) return nullptr;
  ordered_json result = ordered_json::object();
  for (const auto& [process, value] : values) result[process] = value_or_null(value);
  return result;
}

void add_trajectories(ordered_json& document, const RunMetrics& m) {
  document["ate_se3_rmse_m"] = value_or_null(m.online.ate_se3_rmse_m);
  document["ate_origin_rmse_m"] = value_or_null(m.online.ate_origin_rmse_m);
  document["ate_raw_rmse_m"] = value_or_null(m.online.ate_raw_rmse_m);
  document["rpe_1m_rmse_m"] = value_or_null(m.online.rpe_1m_rmse_m);
  document["heading_rmse_rad"] = value_or_null(m.online.heading_rmse_rad);
  document["keyframe_ate_se3_rmse_m"] = value_or_null(m.keyframes.ate_se3_rmse_m);
  document["keyframe_ate_origin_rmse_m"] = value_or_null(m.keyframes.ate_origin_rmse_m);
  document["keyframe_ate_raw_rmse_m"] = value_or_null(m.keyframes.ate_raw_rmse_m);
  document["correction_rmse_m"] = value_or_null(m.correction_rmse_m);
  document["ate_at_80_m"] = value_or_null(m.ate_at_80_m);
  document["ate_per_metre"] = value_or_null(m.ate_per_metre);
}

void add_map(ordered_json& document, const std::string& prefix, const MapFigures& m) {
  document[prefix + "map_error_mean_m"] = value_or_null(m.map_error_mean_m);
  document[prefix + "map_error_p95_m"] = value_or_null(m.map_error_p95_m);
  document[prefix + "map_completeness_mean_m"] = value_or_null(m.map_completeness_mean_m);
  document[prefix + "iou_top8_mean"] = value_or_null(m.iou_top8_mean);
  document[prefix + "iou_mean"] = value_or_null(m.iou_mean);
  document[prefix + "iou_by_class"] = by_class(m.iou_by_class);
}

ordered_json to_document(const RunMetrics& m) {
  ordered_json document = ordered_json::object();
  document["exit_reason"] = value_or_null(m.exit_reason);
  document["frames_total"] = value_or_null(m.frames_total);
  document["frames_tracked"] = value_or_null(m.frames_tracked);
  document["tier_vision_share"] = value_or_null(m.tier_vision_share);
  document["tier_surfaces_share"] = value_or_null(m.tier_surfaces_share);
  document["tier_odometry_share"] = value_or_null(m.tier_odometry_share);
  document["lost_share"] = value_or_null(m.lost_share);
  document["lost_time_s"] = value_or_null(m.lost_time_s);
  document["loop_closures"] = value_or_null(m.loop_closures);
  add_trajectories(document, m);
  add_map(document, "", m.map);
  add_map(document, "ideal_", m.ideal_map);
  add_map(document, "full_", m.full_map);
  add_map(document, "floor_", m.floor_map);
  add_map(document, "mesh_", m.mesh_map);
  document["reference_fusion_share"] = value_or_null(m.reference_fusion_share);
  document["explored_volume_m3"] = value_or_null(m.explored_volume_m3);
  document["explored_share"] = value_or_null(m.explored_share);
  document["explored_share_with_margin"] = value_or_null(m.explored_share_with_margin);
  document["time_to_80_s"] = value_or_null(m.time_to_80_s);
  document["time_to_90_s"] = value_or_null(m.time_to_90_s);
  document["stalled_share"] = value_or_null(m.stalled_share);
  document["path_length_m"] = value_or_null(m.path_length_m);
  document["collisions"] = value_or_null(m.collisions);
  document["planner_state"] = value_or_null(m.planner_state);
  document["planner_reason"] = value_or_null(m.planner_reason);
  document["decisions"] = value_or_null(m.decisions);
  document["failures"] = value_or_null(m.failures);
  document["decision_time_p50_s"] = value_or_null(m.decision_time_p50_s);
  document["decision_time_p95_s"] = value_or_null(m.decision_time_p95_s);
  document["real_time_factor"] = value_or_null(m.real_time_factor);
  document["duration_s"] = value_or_null(m.duration_s);
  document["wall_time_s"] = value_or_null(m.wall_time_s);
  document["cpu_ms_per_frame"] = by_process(m.cpu_ms_per_frame);
  document["peak_rss_mb"] = by_process(m.peak_rss_mb);
  return document;
}

std::string table_text(const ordered_json& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_number_float()) return value.dump();
  char text[64];
  std::snprintf(text, sizeof text, "%.4f", value.get<double>());
  return text;
}

std::string table_row(const std::string& name, const ordered_json& value) {
  constexpr std::size_t kNameWidth = 34;
  std::string row = name;
  row.resize(std::max(row.size() + 1, kNameWidth), ' ');
  return row + table_text(value) + "\n";
}

}  // namespace

TrajectoryFigures trajectory_figures(const Trajectory& reference, const Trajectory& estimate,
                                     const AssociationConfig& association) {
  const auto matches = associate(reference, estimate, association);
  TrajectoryFigures figures;
  figures.ate_se3_rmse_m = position_rmse(matches, Alignment::kSe3);
  figures.ate_origin_rmse_m = position_rmse(matches, Alignment::kOrigin);
  if (const auto raw = absolute_error(matches, Alignment::kNone)) {
    figures.ate_raw_rmse_m = raw->position_m.rmse;
    figures.heading_rmse_rad = raw->heading_rad.rmse;
  }
  const auto relative = relative_error(estimate, matches, {.delta = 1.0, .unit = DeltaUnit::kMetres});
  if (relative) figures.rpe_1m_rmse_m = relative->translation_m.rmse;
  return figures;
}

std::optional<double> ate_raw_rmse_up_to(double path_m, const Trajectory& reference, const Trajectory& estimate,
                                         const AssociationConfig& association) {
  double gone_m = 0.0;
  for (std::size_t i = 1; i < reference.size(); ++i) {
    gone_m += (reference[i].T_world_body.translation() - reference[i - 1].T_world_body.translation()).norm();
    if (gone_m < path_m) continue;
    Trajectory first = estimate;
    std::erase_if(first, [&](const StampedPose& pose) { return pose.stamp > reference[i].stamp; });
    return position_rmse(associate(reference, first, association), Alignment::kNone);
  }
  return std::nullopt;
}

MapFigures map_figures(const LabelledVoxels& reference, const LabelledVoxels& estimate,
                       const std::map<std::uint16_t, std::string>& class_names,
                       const std::vector<std::uint16_t>& top_classes) {
  const MapError error = map_error(reference, estimate);
  const SemanticIou iou = semantic_iou(reference, estimate, top_classes);
  MapFigures figures;
  figures.map_error_mean_m = error.accuracy_mean_m;
  figures.map_error_p95_m = error.accuracy_p95_m;
  figures.map_completeness_mean_m = error.completeness_mean_m;
  figures.iou_top8_mean = iou.top_mean;
  figures.iou_mean = iou.mean;
  for (const ClassIou& c : iou.classes) {
    const auto name = class_names.find(c.label);
    figures.iou_by_class.push_back({name != class_names.end() ? name->second : std::to_string(c.label), c});
  }
  return figures;
}

std::string to_json(const RunMetrics& metrics) {
  return to_document(metrics).dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string format_table(const RunMetrics& metrics) {
  const ordered_json document = to_document(metrics);
  std::string table;
  for (const auto& [key, value] : document.items()) {
    if (key.ends_with("iou_by_class")) continue;
    if (!value.is_object()) {
      table += table_row(key, value);
      continue;
    }
    const std::string prefix = key + ".";
    for (const auto& [process, figure] : value.items()) table += table_row(std::string(prefix).append(process), figure);
  }
  return table;
}

}  // namespace lapis::evaluator
