#include "evaluator/map_judge.hpp"

#include <spdlog/spdlog.h>

#include <map>
#include <stdexcept>
#include <utility>

#include "common/mapping/map_file.hpp"
#include "evaluator/core/map_input.hpp"

namespace lapis::evaluator {
namespace {

constexpr double kMaxDistance_m = 10'000.0;  // the mapper's limit

/// The robot knows how far the camera sees.
EvaluatorConfig with_range(EvaluatorConfig config) {
  config.integration.max_range_m = config.robot.sensing_range_m;
  mapping::validate(config.integration);
  return config;
}

std::map<std::uint16_t, std::string> class_names(const mapping::LabelList& labels) {
  std::map<std::uint16_t, std::string> names;
  for (const auto& label : labels.labels()) names[label.id] = label.name;
  return names;
}

}  // namespace

MapJudge::MapJudge(const EvaluatorConfig& config)
    : config_(with_range(config)), reference_(config_.resolution_m),
      plain_fusion_({config_.resolution_m, config_.integration.min_range_m, config_.robot.sensing_range_m}) {}

void MapJudge::set_labels(mapping::LabelList labels) {
  labels_ = std::move(labels);
  config_.frame.max_label = labels_.largest_accepted_id();
}

std::string MapJudge::add_reference_frame(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth_m,
                                          const geometry::LabelImage& labels, const geometry::Pose& T_map_camera) {
  std::string error;
  const auto frame =
      mapping::CompactFrame::make(camera, depth_m, labels.empty() ? nullptr : &labels, config_.frame, error);
  if (!frame) return error;
  if (T_map_camera.translation().norm() > kMaxDistance_m) return "true pose is more than 10 km from the map's origin";
  reference_.add(mapping::compute_votes(*frame, T_map_camera, config_.integration, config_.resolution_m));
  plain_fusion_.add(camera, depth_m, labels, T_map_camera);
  return "";
}

std::filesystem::path MapJudge::truth_folder() const {
  if (!config_.ground_truth_dir.empty()) return config_.ground_truth_dir;
  return std::filesystem::path(config_.output_dir) / "ground_truth";
}

std::string MapJudge::find_truth(const geometry::Pose& T_map_world) {
  if (truth_) return "";
  std::string problem;
  auto truth = load_ground_truth(truth_folder(), problem);
  if (!truth) return problem;
  if (truth->mesh.occupied.resolution_m != config_.resolution_m) {
    return fmt::format("its voxels have {} m, evaluator.resolution_m is {}", truth->mesh.occupied.resolution_m,
                       config_.resolution_m);
  }
  if (!is_same_frame(truth->T_map_world, T_map_world)) return "slam's first pose is not where the run began";
  truth_ = std::move(truth);
  return "";
}

mapping::BeliefReader MapJudge::belief_reader() const {
  auto model = config_.sensor_model;
  if (labels_.max_id() > 1) model.class_count = labels_.max_id();
  return mapping::BeliefReader(model);
}

/// Only slam's first map has the frame of the truth.
bool MapJudge::is_comparable(const KnownSpace& map) const {
  return map_session_ == judged_session_ && map.occupied.resolution_m == config_.resolution_m;
}

std::optional<double> MapJudge::explored_share() const {
  if (!truth_ || mirror_.map() == nullptr) return std::nullopt;
  const KnownSpace space = to_known_space(*mirror_.map(), belief_reader());
  return is_comparable(space) ? coverage(truth_->mesh, space).explored_share : std::nullopt;
}

void MapJudge::write_to(TimelineRow& row) {
  if (mirror_.map() == nullptr) return;
  const KnownSpace space = to_known_space(*mirror_.map(), belief_reader());
  row.explored_volume_m3 = coverage(space).explored_volume_m3;
  row.is_comparable = is_comparable(space);
  if (row.is_comparable) known_.add(space);
}

void MapJudge::add_shares(std::vector<TimelineRow>& rows) const {
  if (!truth_) return;
  const auto shares = known_.shares(truth_->mesh);
  auto next = shares.begin();
  for (TimelineRow& row : rows) {
    if (row.is_comparable && next != shares.end()) row.explored_share = *next++;
  }
}

void MapJudge::write_to(RunMetrics& m, bool has_reference) const {
  if (mirror_.map() == nullptr) return;
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
    spdlog::warn("the map has voxels of {} m, evaluator.resolution_m is {}: no map figures",
                 estimate.occupied.resolution_m, config_.resolution_m);
    return;
  }
  const KnownSpace reference = to_known_space(reference_, reader);
  const auto names = class_names(labels_);
  const auto classes = truth_ ? truth_->top_classes : std::vector<std::uint16_t>{};
  m.map = map_figures(reference.occupied, estimate.occupied, names, classes);
  m.reference_fusion_share = plain_fusion_.share_in(reference.occupied);
  if (!truth_) return;
  m.explored_share = coverage(truth_->mesh, estimate).explored_share;
  m.mesh_map = map_figures(truth_->mesh.occupied, estimate.occupied, names, classes);
  if (const auto ideal = load_ideal()) m.ideal_map = map_figures(*ideal, estimate.occupied, names, classes);
}

/// Occupied voxels of the map without noise, which the simulator writes at its end.
std::optional<LabelledVoxels> MapJudge::load_ideal() const {
  const auto file = truth_folder() / "ideal.lapis";
  if (!std::filesystem::exists(file)) return std::nullopt;
  std::string problem;
  const auto ideal = mapping::load_map(file.string(), problem);
  if (ideal && ideal->map.resolution_m() == config_.resolution_m) {
    return to_known_space(ideal->map, mapping::BeliefReader(ideal->sensor_model)).occupied;
  }
  spdlog::warn("no figures against the ideal map: {}", ideal ? file.string() + " has other voxels" : problem);
  return std::nullopt;
}

void MapJudge::save_reference(const std::filesystem::path& file) const {
  const mapping::MapFile reference{reference_, belief_reader().model(), labels_, {{"source", "true poses"}}};
  if (const auto problem = mapping::save_map(file.string(), reference)) throw std::runtime_error(*problem);
}

}  // namespace lapis::evaluator
