#include "evaluator/evaluator_component.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "common/files/atomic_file.hpp"
#include "common/mapping/map_file.hpp"
#include "common/messages/camera.hpp"
#include "common/messages/labels.hpp"
#include "common/messages/planner.hpp"
#include "common/messages/time.hpp"
#include "evaluator/core/coverage.hpp"
#include "evaluator/core/map_input.hpp"
#include "evaluator/figures.hpp"

namespace lapis::evaluator {
namespace {

constexpr std::size_t kWaitingFrames = 30;
constexpr double kMaxDistance_m = 10'000.0;  // the mapper's limit
constexpr std::chrono::seconds kProgressPeriod(2);

std::map<std::uint16_t, std::string> class_names(const mapping::LabelList& labels) {
  std::map<std::uint16_t, std::string> names;
  for (const auto& label : labels.labels()) names[label.id] = label.name;
  return names;
}

/// Root of the sum of the variances of x, y and z [m]; none when the covariance is none.
std::optional<double> position_sigma_m(const nav_msgs::msg::Odometry& message) {
  const auto& covariance = message.pose().covariance();  // 6x6, row by row
  const double sum = covariance[0] + covariance[7] + covariance[14];
  return sum >= 0.0 ? std::optional(std::sqrt(sum)) : std::nullopt;
}

Trajectory keyframes_of(const lapis_msgs::msg::PoseGraph& graph) {
  Trajectory trajectory;
  for (const auto& node : graph.nodes()) {
    const time::Time stamp = messages::from_message(node.stamp());
    const auto T_map_camera = messages::from_message(node.pose());
    if (T_map_camera && (trajectory.empty() || trajectory.back().stamp < stamp)) {
      trajectory.push_back({stamp, *T_map_camera});
    }
  }
  return trajectory;
}

}  // namespace

EvaluatorComponent::EvaluatorComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), tracked_(context, topics::kTrackedFrame, "slam frame", kWaitingFrames),
      truth_(context, topics::kGroundTruth, "ground truth", kWaitingFrames),
      depth_(context, topics::kDepth, "depth", kWaitingFrames),
      labels_(context, topics::kLabels, "labels", kWaitingFrames),
      info_(context, topics::kDepthInfo, "camera info", kWaitingFrames), reference_(config.resolution_m),
      plain_fusion_({config.resolution_m, config.integration.min_range_m, config.robot.sensing_range_m}) {
  if (config_.output_dir.empty()) {
    throw std::runtime_error("evaluator.output_dir is not set; give --set evaluator.output_dir=FOLDER");
  }
  files::require_writable_folder(config_.output_dir, "evaluator.output_dir");
  config_.integration.max_range_m = config_.robot.sensing_range_m;
  mapping::validate(config_.integration);
  info_.on_arrival([this](time::Time stamp) { count_frame(stamp); });
  context.subscribe(topics::kStaticTransforms, [this](const auto& m) { static_transforms_.add(m); });
  context.subscribe(topics::kPoseGraph, [this](auto& m) {
    if (!session_ || m.session() == *session_) graph_ = std::move(m);
  });
  context.subscribe(topics::kSlamOdometry, [this](const auto& m) { position_sigma_m_ = position_sigma_m(m); });
  context.subscribe(topics::kPlannerStatus, [this](const auto& m) { on_planner_status(m); });
  context.subscribe(topics::kVoxelTiles, [this](const auto& m) { on_tile(m); });
  context.subscribe(topics::kMapState, [this](const auto& m) { on_map_state(m); });
  context.subscribe(topics::kDiagnostics, [this](const auto& m) { on_diagnostics(m); });
  context.subscribe(topics::kLabelInfo, [this](const vision_msgs::msg::LabelInfo& m) {
    auto labels = messages::from_message(m);
    if (!labels) return spdlog::warn("label list refused: {}", labels.reason);
    label_list_ = std::move(*labels);
    config_.frame.max_label = label_list_.largest_accepted_id();
  });
  context.subscribe(topics::kCollision, [this](const std_msgs::msg::Bool& m) { count_contact(m.data()); });
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
}

// The camera's frames, not slam's: a frame that slam had to drop, or never got, is a frame without a pose.
void EvaluatorComponent::count_frame(time::Time stamp) {
  const bool is_repeated = camera_stamp_ && stamp <= *camera_stamp_ && *camera_stamp_ - stamp <= time::kRestartGap;
  if (is_repeated) return;  // lock-step may repeat one
  camera_stamp_ = stamp;
  ++frames_total_;
}

// Told on change, and lock-step may repeat it: a collision is the beginning of a contact.
void EvaluatorComponent::count_contact(bool is_in_contact) {
  if (!collisions_) collisions_ = 0;
  if (is_in_contact && !is_in_contact_) ++*collisions_;
  is_in_contact_ = is_in_contact;
  context_.status().value("collisions", static_cast<std::uint64_t>(*collisions_));
}

void EvaluatorComponent::on_diagnostics(const diagnostic_msgs::msg::DiagnosticArray& message) {
  for (const auto& status : message.status()) {
    if (status.name() != context_.frame(status.hardware_id())) continue;  // another robot's, or no process of Lapis
    costs_.add(status);
  }
}

void EvaluatorComponent::on_tile(const lapis_msgs::msg::VoxelTile& message) {
  mapping::TileIndex index;
  index.x = message.x();
  index.y = message.y();
  index.z = message.z();
  const auto result = mirror_.apply_tile(message.epoch(), index, message.version(), message.data());
  if (result == mapping::TileResult::kDamaged) context_.status().count("damaged tiles");
}

void EvaluatorComponent::on_map_state(const lapis_msgs::msg::MapState& message) {
  mapping::MapState state;
  state.epoch = message.epoch();
  state.version = message.version();
  state.tiles = message.tiles();
  state.checksum = message.checksum();
  state.resolution_m = message.resolution_m();
  mirror_.apply_state(state);
  map_session_ = message.session();
}

void EvaluatorComponent::on_planner_status(const lapis_msgs::msg::PlannerStatus& message) {
  planner_ = message;
  decisions_.add({message.decisions(), message.decisions_unlike_mi_only(), message.decision_time_s()});
}

void EvaluatorComponent::work(const runtime::Cycle& cycle) {
  while (next_frame(cycle)) {
  }
  has_ended_ |= cycle.is_final;
  const auto now = std::chrono::steady_clock::now();
  if (!planner_ || timeline_.empty() || (!cycle.is_final && now - reported_ < kProgressPeriod)) return;
  reported_ = now;
  report_progress();
}

/// The line by which explore.sh shows how far the robot is.
void EvaluatorComponent::report_progress() {
  find_truth();
  const TimelineRow& row = timeline_.back();
  std::string explored = fmt::format("{:.0f} m3 explored", row.explored_volume_m3.value_or(0.0));
  if (scene_truth_ && mirror_.map() != nullptr && row.is_comparable) {
    const KnownSpace space = to_known_space(*mirror_.map(), belief_reader());
    explored += fmt::format(" ({:.1f} %)", 100.0 * coverage(scene_truth_->mesh, space).explored_share.value_or(0.0));
  }
  spdlog::info("progress: {:.0f} s, {}, {:.1f} m driven, loops closed: {}, {}: {}", row.time_s, explored,
               row.path_length_m.value_or(0.0), loop_closures(), messages::state_name(*planner_), planner_->reason());
}

/// Joins and records the oldest tracked frame; false when its partners may still come.
bool EvaluatorComponent::next_frame(const runtime::Cycle& cycle) {
  using time::Match;
  if (tracked_.empty()) return false;
  const auto tolerance = time::Duration::from_seconds(config_.max_stamp_difference_s);
  auto& [stamp, tracked] = tracked_.front();
  const time::Time now = stamp;
  const auto is_over = [&](const auto& input) { return cycle.inputs_complete || !input.has_publisher(); };
  Odometry* truth = nullptr;
  Image* depth = nullptr;
  Image* labels = nullptr;
  Info* info = nullptr;
  const auto truth_match = truth_.match(now, tolerance, is_over(truth_), truth);
  const auto depth_match = depth_.match(now, tolerance, is_over(depth_), depth);
  const auto label_match = labels_.match(now, tolerance, is_over(labels_), labels);
  const auto info_match = info_.match(now, tolerance, is_over(info_), info);
  if (truth_match == Match::kWait || depth_match == Match::kWait || label_match == Match::kWait ||
      info_match == Match::kWait) {
    return false;
  }
  if (truth != nullptr && !cycle.inputs_complete && !is_mount_known(*truth, tracked)) return false;
  record(tracked, truth, depth, labels, info);
  tracked_.drop_until(now);
  truth_.drop_until(now - tolerance);
  depth_.drop_until(now - tolerance);
  labels_.drop_until(now - tolerance);
  info_.drop_until(now - tolerance);
  return true;
}

/// True when the camera's mount is known, without which a true pose of the base says nothing of the camera.
bool EvaluatorComponent::is_mount_known(const Odometry& truth, const Tracked& tracked) {
  const std::string& optical_frame = tracked.header().frame_id();
  if (static_transforms_.find(truth.child_frame_id(), optical_frame)) return true;
  if (context_.rate_limit().pass("mount")) {
    spdlog::warn("waiting: no transform from {} to {} on /tf_static", truth.child_frame_id(), optical_frame);
  }
  return false;
}

void EvaluatorComponent::record(const Tracked& tracked, const Odometry* truth, const Image* depth, const Image* labels,
                                const Info* info) {
  const time::Time stamp = messages::from_message(tracked.header().stamp());
  newest_ = std::chrono::steady_clock::now();
  if (!began_) began_ = newest_;
  ++frames_judged_;
  context_.status().value("frames", static_cast<std::uint64_t>(frames_judged_));
  const bool is_judged = is_of_judged_session(tracked);
  const bool is_tracking = is_judged && tracked.state() == lapis_msgs::msg::TrackedFrame_Constants::STATE_TRACKING;
  if (!first_stamp_) first_stamp_ = last_stamp_ = stamp;
  if (stamp > last_stamp_) {  // a source that began anew goes back
    if (!is_tracking) lost_time_s_ += (stamp - last_stamp_).seconds();
    last_stamp_ = stamp;
  }

  std::optional<geometry::Pose> T_world_camera;
  if (truth != nullptr) T_world_camera = true_camera_pose(*truth, tracked.header().frame_id());
  const bool is_new = truth_world_.empty() || truth_world_.back().stamp < stamp;
  if (T_world_camera && is_new) truth_world_.push_back({stamp, *T_world_camera});
  if (!is_tracking) return add_timeline_row(stamp, false);
  const auto T_map_keyframe = messages::from_message(tracked.keyframe_pose());
  const auto T_keyframe_camera = messages::from_message(tracked.pose_in_keyframe());
  if (!T_map_keyframe || !T_keyframe_camera) return context_.status().count("tracked frames without a valid pose");
  ++frames_tracked_;
  const geometry::Pose T_map_camera = *T_map_keyframe * *T_keyframe_camera;
  if (estimate_.empty() || estimate_.back().stamp < stamp) estimate_.push_back({stamp, T_map_camera});
  if (T_world_camera && !T_map_world_) T_map_world_ = T_map_camera * T_world_camera->inverse();
  if (T_world_camera && depth != nullptr && info != nullptr) {
    add_to_references(*T_world_camera, *depth, labels, *info);
  }
  add_timeline_row(stamp, true);
}

std::filesystem::path EvaluatorComponent::truth_folder() const {
  if (!config_.ground_truth_dir.empty()) return config_.ground_truth_dir;
  return std::filesystem::path(config_.output_dir) / "ground_truth";
}

/// Ground truth of the scene, which the simulator writes while the run goes on. Tells what is wrong with it.
std::string EvaluatorComponent::find_truth() {
  if (scene_truth_ || !T_map_world_) return "";
  std::string problem;
  auto truth = load_ground_truth(truth_folder(), problem);
  if (!truth) return problem;
  if (truth->mesh.occupied.resolution_m != config_.resolution_m) {
    return fmt::format("its voxels have {} m, evaluator.resolution_m is {}", truth->mesh.occupied.resolution_m,
                       config_.resolution_m);
  }
  if (!is_same_frame(truth->T_map_world, *T_map_world_)) return "slam's first pose is not where the run began";
  scene_truth_ = std::move(truth);
  return "";
}

// The run is judged in the frame of slam's first map: poses of a later session have another origin.
bool EvaluatorComponent::is_of_judged_session(const Tracked& tracked) {
  if (!session_) session_ = tracked.session();
  if (*session_ == tracked.session()) return true;
  context_.status().count("frames not judged: slam began a new map");
  return false;
}

std::optional<geometry::Pose> EvaluatorComponent::true_camera_pose(const Odometry& truth,
                                                                   const std::string& optical_frame) {
  const auto T_world_base = messages::from_message(truth.pose().pose());
  const auto T_base_camera = static_transforms_.find(truth.child_frame_id(), optical_frame);
  if (!T_world_base || !T_base_camera) return std::nullopt;
  return *T_world_base * *T_base_camera;
}

// The references judge the map, so only frames that slam tracked, which the map can hold, are in them.
void EvaluatorComponent::add_to_references(const geometry::Pose& T_world_camera, const Image& depth,
                                           const Image* labels, const Info& info) {
  const auto camera = messages::from_message(info);
  if (!camera) return context_.status().count("frames not in the reference: " + camera.reason);
  const auto metres = messages::to_depth(depth);
  if (!metres) return context_.status().count("frames not in the reference: " + metres.reason);
  geometry::LabelImage ids;
  if (labels != nullptr) {
    if (auto converted = messages::to_labels(*labels)) ids = std::move(*converted);
  }
  std::string error;
  const auto frame = mapping::CompactFrame::make(*camera, *metres, ids.empty() ? nullptr : &ids, config_.frame, error);
  if (!frame) return context_.status().count("frames not in the reference: " + error);
  const geometry::Pose T_map_camera = *T_map_world_ * T_world_camera;
  if (T_map_camera.translation().norm() > kMaxDistance_m) {
    return context_.status().count("frames not in the reference: true pose is more than 10 km from the map's origin");
  }
  reference_.add(mapping::compute_votes(*frame, T_map_camera, config_.integration, config_.resolution_m));
  plain_fusion_.add(*camera, *metres, ids, T_map_camera);
}

void EvaluatorComponent::add_timeline_row(time::Time stamp, bool is_tracking) {
  if (timeline_stamp_ && (stamp - *timeline_stamp_).seconds() < config_.timeline_period_s) return;
  timeline_stamp_ = stamp;
  TimelineRow row;
  row.time_s = (stamp - *first_stamp_).seconds();
  row.is_tracking = is_tracking;
  if (is_tracking) row.position_sigma_m = position_sigma_m_;
  if (planner_) row.planner_state = messages::state_name(*planner_);
  if (const auto* map = mirror_.map()) {
    const KnownSpace space = to_known_space(*map, belief_reader());
    row.explored_volume_m3 = coverage(space).explored_volume_m3;
    row.is_comparable = is_comparable(space);
    if (row.is_comparable) known_.add(space);
  }
  if (is_tracking && T_map_world_ && !truth_world_.empty() && truth_world_.back().stamp == stamp) {
    const geometry::Pose truth = *T_map_world_ * truth_world_.back().T_world_body;
    row.position_error_m = (estimate_.back().T_world_body.translation() - truth.translation()).norm();
  }
  if (!truth_world_.empty()) row.path_length_m = path_length_m(truth_world_);
  timeline_.push_back(row);
}

/// Only slam's first map has the frame of the truth.
bool EvaluatorComponent::is_comparable(const KnownSpace& map) const {
  return map_session_ == session_ && map.occupied.resolution_m == config_.resolution_m;
}

/// Explored shares of the rows of the timeline.
void EvaluatorComponent::add_shares() {
  if (!scene_truth_) return;
  const auto shares = known_.shares(scene_truth_->mesh);
  auto next = shares.begin();
  for (TimelineRow& row : timeline_) {
    if (row.is_comparable && next != shares.end()) row.explored_share = *next++;
  }
}

mapping::BeliefReader EvaluatorComponent::belief_reader() const {
  auto model = config_.sensor_model;
  if (label_list_.max_id() > 1) model.class_count = label_list_.max_id();
  return mapping::BeliefReader(model);
}

Trajectory EvaluatorComponent::truth_in_map() const {
  return T_map_world_ ? express_in(*T_map_world_, truth_world_) : Trajectory{};
}

std::int64_t EvaluatorComponent::loop_closures() const {
  return std::count_if(graph_.edges().begin(), graph_.edges().end(), [](const auto& edge) {
    return edge.type() == lapis_msgs::msg::PoseGraphEdge_Constants::TYPE_LOOP_CLOSURE;
  });
}

RunMetrics EvaluatorComponent::metrics() const {
  RunMetrics m;
  // A camera info that was lost on its way here is a frame, too, and so is a frame that slam answered.
  m.frames_total = std::max(frames_total_ + static_cast<std::int64_t>(info_.missed()), frames_judged_);
  m.exit_reason = judged_exit_reason(has_ended_ ? "completed" : "stopped", frames_tracked_, *m.frames_total);
  m.frames_tracked = frames_tracked_;
  m.lost_time_s = lost_time_s_;
  m.loop_closures = loop_closures();
  const Trajectory truth = truth_in_map(), keyframes = keyframes_of(graph_);
  m.correction_rmse_m = trajectory_figures(estimate_, keyframes).ate_raw_rmse_m;
  if (!truth.empty()) {
    m.online = trajectory_figures(truth, estimate_);
    m.keyframes = trajectory_figures(truth, keyframes);
    m.path_length_m = path_length_m(truth);
    m.ate_at_80_m = ate_raw_rmse_up_to(80.0, truth, estimate_);
    if (*m.path_length_m > 0.0 && m.online.ate_raw_rmse_m)
      m.ate_per_metre = *m.online.ate_raw_rmse_m / *m.path_length_m;
  }
  if (first_stamp_) {
    m.duration_s = (last_stamp_ - *first_stamp_).seconds();
    m.wall_time_s = std::chrono::duration<double>(newest_ - *began_).count();
    if (*m.wall_time_s > 0.0) m.real_time_factor = *m.duration_s / *m.wall_time_s;
  }
  costs_.write_to(m);
  decisions_.write_to(m);
  if (planner_) m.planner_state = messages::state_name(*planner_);
  m.collisions = collisions_;
  m.time_to_80_s = time_to_reach(timeline_, 0.8);
  m.time_to_90_s = time_to_reach(timeline_, 0.9);
  add_map_figures(m);
  return m;
}

void EvaluatorComponent::add_map_figures(RunMetrics& m) const {
  if (mirror_.map() == nullptr) return;
  if (map_session_ != session_) {
    spdlog::warn("the map belongs to a later session of slam than the run's first frame: no map figures");
    return;
  }
  if (!mirror_.is_consistent()) spdlog::warn("the map's last version did not arrive whole; an older one is judged");
  const auto reader = belief_reader();
  const KnownSpace estimate = to_known_space(*mirror_.map(), reader);
  m.explored_volume_m3 = coverage(estimate).explored_volume_m3;
  if (!T_map_world_) return;
  if (estimate.occupied.resolution_m != config_.resolution_m) {
    spdlog::warn("the map has voxels of {} m, evaluator.resolution_m is {}: no map figures",
                 estimate.occupied.resolution_m, config_.resolution_m);
    return;
  }
  const KnownSpace reference = to_known_space(reference_, reader);
  const auto names = class_names(label_list_);
  const auto classes = scene_truth_ ? scene_truth_->top_classes : std::vector<std::uint16_t>{};
  m.map = map_figures(reference.occupied, estimate.occupied, names, classes);
  m.reference_fusion_share = plain_fusion_.share_in(reference.occupied);
  if (!scene_truth_) return;
  m.explored_share = coverage(scene_truth_->mesh, estimate).explored_share;
  m.mesh_map = map_figures(scene_truth_->mesh.occupied, estimate.occupied, names, classes);
  if (const auto ideal = load_ideal()) m.ideal_map = map_figures(*ideal, estimate.occupied, names, classes);
}

/// Occupied voxels of the map without noise, which the simulator writes at its end.
std::optional<LabelledVoxels> EvaluatorComponent::load_ideal() const {
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

void EvaluatorComponent::write_files(const RunMetrics& m) const {
  const std::filesystem::path folder(config_.output_dir);
  trajectory::write_trajectory(folder / "trajectory_estimate.txt", estimate_,
                               "camera optical frame in the map, as published");
  trajectory::write_trajectory(folder / "trajectory_ground_truth.txt", truth_in_map(),
                               "true camera optical frame, in the map by the first true pose");
  files::replace_text(folder / "timeline.csv", to_csv(timeline_));
  files::replace_text(folder / "metrics.json", to_json(m));
  if (!T_map_world_) return;
  const mapping::MapFile reference{reference_, belief_reader().model(), label_list_, {{"source", "true poses"}}};
  if (const auto problem = mapping::save_map((folder / "reference_map.lapis").string(), reference)) {
    throw std::runtime_error(*problem);
  }
}

void EvaluatorComponent::finish() {
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
  if (frames_total_ == 0 && frames_judged_ == 0) {
    spdlog::warn("no frame came; nothing is written");
    return;
  }
  if (const auto problem = find_truth(); !problem.empty()) {
    spdlog::warn("ground truth of the scene is left out: {}", problem);
  }
  add_shares();
  const RunMetrics m = metrics();
  write_files(m);
  std::cout << format_table(m) << std::flush;
  if (config_.figures) draw_figures(config_.output_dir);
}

}  // namespace lapis::evaluator
