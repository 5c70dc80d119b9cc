#include "evaluator/map_judge.hpp"

#include <spdlog/spdlog.h>

#include <map>
#include <stdexcept>
#include <utility>

#include "common/mapping/file/map_file.hpp"
#include "evaluator/core/map/map_input.hpp"

namespace lapis::evaluator {
namespace {

constexpr double kMaxDistance_m = 10'000.0;  // the mapper's limit

/// The first difference between a map file and the description; empty when the two maps can be compared.
std::string unlike(const mapping::MapFile& file, const mapping::MapDescription& description) {
  if (file.map.resolution_m() != description.resolution_m)
    return fmt::format("resolution_m {} and {}", file.map.resolution_m(), description.resolution_m);
  if (!file.frames) return "it does not say how frames entered it";
  return mapping::difference(*file.frames, description.frames);
}

std::map<std::uint16_t, std::string> class_names(const mapping::LabelList& labels) {
  std::map<std::uint16_t, std::string> names;
  for (const auto& label : labels.labels()) names[label.id] = label.name;
  return names;
}

}  // namespace

MapJudge::References::References(const mapping::MapDescription& description)
    : map(description.resolution_m), plain_fusion({description.resolution_m, description.frames.integration.min_range_m,
                                                   description.frames.integration.max_range_m}) {}

std::string MapJudge::set_description(mapping::MapDescription description) {
  description.frames = mapping::of_reference(description.frames);
  if (!description_) {
    references_.emplace(description);
  } else if (auto unlike = mapping::difference(*description_, description); !unlike.empty()) {
    return unlike;
  }
  description_ = std::move(description);
  return "";
}

std::string MapJudge::add_reference_frame(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth_m,
                                          const geometry::LabelImage& labels, const geometry::Pose& T_map_camera) {
  if (!description_) return "no mapper has said how its map is built";
  const auto& [integration, stride] = description_->frames;
  const mapping::CompactFrameConfig compact{stride, description_->labels.largest_accepted_id()};
  std::string error;
  const auto frame = mapping::CompactFrame::make(camera, depth_m, labels.empty() ? nullptr : &labels, compact, error);
  if (!frame) return error;
  if (T_map_camera.translation().norm() > kMaxDistance_m) return "true pose is more than 10 km from the map's origin";
  references_->map.add(mapping::compute_votes(*frame, T_map_camera, integration, description_->resolution_m));
  references_->plain_fusion.add(camera, depth_m, labels, T_map_camera);
  return "";
}

std::string MapJudge::find_truth(const geometry::Pose& T_map_world) {
  if (truth_ || !description_) return "";
  std::string problem;
  auto truth = load_ground_truth(truth_folder_, problem);
  if (!truth) return problem;
  if (truth->mesh.occupied.resolution_m != description_->resolution_m) {
    return fmt::format("{}: resolution_m is {}, of the map it is {}", (truth_folder_ / "mesh.lapis").string(),
                       truth->mesh.occupied.resolution_m, description_->resolution_m);
  }
  if (!is_same_frame(truth->T_map_world, T_map_world)) return "slam's first pose is not where the run began";
  truth_ = std::move(truth);
  return "";
}

/// True when the map has the grid of the ground truth and belongs to slam's first map, the only one in the frame of the
/// truth.
bool MapJudge::is_comparable(const KnownSpace& map) const {
  return map_session_ == judged_session_ && map.occupied.resolution_m == description_->resolution_m;
}

std::optional<double> MapJudge::explored_share() const {
  if (!truth_ || !is_map_known()) return std::nullopt;
  const KnownSpace space = to_known_space(*mirror_.map(), belief_reader());
  return is_comparable(space) ? coverage(truth_->mesh, space).explored_share : std::nullopt;
}

void MapJudge::write_to(TimelineRow& row) {
  if (!is_map_known()) return;
  const KnownSpace space = to_known_space(*mirror_.map(), belief_reader());
  row.explored_volume_m3 = coverage(space).explored_volume_m3;
  row.is_comparable = is_comparable(space);
  if (row.is_comparable) known_.add(space);
}

void MapJudge::add_shares(std::vector<TimelineRow>& rows) const {
  if (!truth_) return;
  const auto fill = [&](const KnownSpace& explorable, std::optional<double> TimelineRow::*share) {
    const auto shares = known_.shares(explorable);
    auto next = shares.begin();
    for (TimelineRow& row : rows) {
      if (row.is_comparable && next != shares.end()) row.*share = *next++;
    }
  };
  fill(truth_->mesh, &TimelineRow::explored_share);
  if (truth_->with_margin) fill(*truth_->with_margin, &TimelineRow::explored_share_with_margin);
}

void MapJudge::write_to(RunMetrics& m, bool has_reference) const {
  if (!is_map_known()) return;
  if (map_session_ != judged_session_) {
    spdlog::warn("the map belongs to a later session of slam than the run's first frame: no map figures");
    return;
  }
  if (!mirror_.is_consistent()) spdlog::warn("the map's last version did not arrive whole; an older one is judged");
  const auto reader = belief_reader();
  const KnownSpace estimate = to_known_space(*mirror_.map(), reader);
  m.explored_volume_m3 = coverage(estimate).explored_volume_m3;
  if (!has_reference) return;
  if (!is_comparable(estimate)) {
    spdlog::warn("the map has voxels of {} m, its description says {}: no map figures", estimate.occupied.resolution_m,
                 description_->resolution_m);
    return;
  }
  const KnownSpace reference = to_known_space(references_->map, reader);
  const auto names = class_names(description_->labels);
  const auto classes = truth_ ? truth_->top_classes : std::vector<std::uint16_t>{};
  m.map = map_figures(reference.occupied, estimate.occupied, names, classes);
  m.reference_fusion_share = references_->plain_fusion.share_in(reference.occupied);
  if (!truth_) return;
  m.explored_share = coverage(truth_->mesh, estimate).explored_share;
  if (truth_->with_margin) m.explored_share_with_margin = coverage(*truth_->with_margin, estimate).explored_share;
  m.mesh_map = map_figures(truth_->mesh.occupied, estimate.occupied, names, classes);
  if (const auto ideal = load_exact("ideal.lapis")) {
    m.ideal_map = map_figures(*ideal, estimate.occupied, names, classes);
  }
  if (const auto full = load_exact("full.lapis")) {
    m.full_map = map_figures(*full, estimate.occupied, names, classes);
    m.floor_map = map_figures(*full, reference.occupied, names, classes);
  }
}

/// Occupied voxels of a map without noise that the simulator has written. None, with a warning, when it was not built
/// in the same way as the map.
std::optional<LabelledVoxels> MapJudge::load_exact(const std::string& name) const {
  const std::string file = (truth_folder_ / name).string();
  if (!std::filesystem::exists(file)) return std::nullopt;
  std::string problem;
  const auto exact = mapping::load_map(file, problem);
  if (exact) problem = unlike(*exact, *description_);
  if (problem.empty()) return to_known_space(exact->map, mapping::BeliefReader(exact->sensor_model)).occupied;
  spdlog::warn("no figures against {}: {}", name, exact ? file + " was not built as the map: " + problem : problem);
  return std::nullopt;
}

void MapJudge::save_reference(const std::filesystem::path& file) const {
  if (!references_) return;
  const mapping::MapFile reference{references_->map,
                                   description_->sensor_model,
                                   description_->labels,
                                   {{"source", "true poses"}},
                                   description_->frames};
  if (const auto problem = mapping::save_map(file.string(), reference)) throw std::runtime_error(*problem);
}

}  // namespace lapis::evaluator
