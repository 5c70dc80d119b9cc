#include "evaluator/evaluator_component.hpp"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>

#include "common/files/atomic_file.hpp"
#include "common/messages/camera.hpp"
#include "common/messages/exploration_state.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/diagnostics.hpp"
#include "common/topics/ground_truth.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"
#include "evaluator/figures.hpp"

namespace lapis::evaluator {
namespace {

constexpr std::size_t kWaitingFrames = 90;                   // for their labels: three seconds at 30 Hz
constexpr std::size_t kWaitingImages = kWaitingFrames + 30;  // images wait for slam's pose, too: one second more
constexpr std::size_t kWaitingInfos = kWaitingImages + 34;   // on a network they are ahead by half a second more
constexpr std::chrono::seconds kProgressPeriod(2);
constexpr double kLongestJudging_s = 900.0;  // to compare maps, write files and draw figures

/// Root of the sum of the variances of x, y and z [m]; none when the covariance is not valid.
std::optional<double> position_sigma_m(const nav_msgs::msg::Odometry& message) {
  const auto& covariance = message.pose().covariance();  // 6x6, row-major
  const double sum = covariance[0] + covariance[7] + covariance[14];
  return sum >= 0.0 ? std::optional(std::sqrt(sum)) : std::nullopt;
}

PoseTier tier_of(const lapis_msgs::msg::TrackedFrame& tracked) {
  using namespace lapis_msgs::msg::TrackedFrame_Constants;
  switch (tracked.source()) {
    case SOURCE_VISION: return PoseTier::kVision;
    case SOURCE_SURFACES: return PoseTier::kSurfaces;
    case SOURCE_ODOMETRY: return PoseTier::kOdometry;
    default: return PoseTier::kNone;
  }
}

std::filesystem::path truth_folder(const EvaluatorConfig& config) {
  if (!config.ground_truth_dir.empty()) return config.ground_truth_dir;
  return std::filesystem::path(config.output_dir) / "ground_truth";
}

KeyframePoses keyframes_of(const lapis_msgs::msg::PoseGraph& graph) {
  KeyframePoses keyframes;
  for (const auto& node : graph.nodes()) {
    if (const auto T_map_camera = messages::from_message(node.pose())) keyframes.emplace(node.id(), *T_map_camera);
  }
  return keyframes;
}

}  // namespace

EvaluatorComponent::EvaluatorComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), tracked_(context, topics::kTrackedFrame, "slam frame", kWaitingFrames),
      odometry_(context, topics::kSlamOdometry, "slam odometry", kWaitingImages),
      truth_(context, topics::kGroundTruth, "ground truth", kWaitingImages),
      depth_(runtime::depth_input(context, kWaitingImages)),
      labels_(context, topics::kLabels, "labels", kWaitingImages),
      info_(context, topics::kColorInfo, "camera info", kWaitingInfos), depth_camera_(context, static_transforms_),
      maps_(truth_folder(config)) {
  if (config_.output_dir.empty()) {
    throw std::runtime_error("evaluator.output_dir is not set; give --set evaluator.output_dir=FOLDER");
  }
  files::require_writable_folder(config_.output_dir, "evaluator.output_dir");
  info_.on_arrival([this](time::Time stamp) { record_.count_camera_frame(stamp); });
  info_.on_clock_set([this](time::Duration step) { record_.follow_camera_clock(step); });
  tracked_.on_clock_set([this](time::Duration step) { follow_clock(step); });
  context.subscribe(topics::kStaticTransforms, [this](const auto& m) { static_transforms_.add(m); });
  depth_camera_.follow(context, topics::kDepthEstimate);
  context.subscribe(topics::kPoseGraph, [this](auto& m) {
    if (!record_.session() || m.session() == *record_.session()) graph_ = std::move(m);
  });
  context.subscribe(topics::kPlannerStatus, [this](const auto& m) { on_planner_status(m); });
  context.subscribe(topics::kMapDescription, [this](const auto& m) { on_map_description(m); });
  context.subscribe(topics::kVoxelTiles, [this](const auto& m) { on_tile(m); });
  context.subscribe(topics::kMapState, [this](const auto& m) { on_map_state(m); });
  context.subscribe(topics::kDiagnostics, [this](const auto& m) { on_diagnostics(m); });
  context.subscribe(topics::kCollision, [this](const std_msgs::msg::Bool& m) { count_contact(m.data()); });
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
}

/// The frames that wait are the first ones by the clock as it is set now. Their partners may notice that later.
void EvaluatorComponent::follow_clock(time::Duration step) {
  const time::Time first = tracked_.front().first;
  for (auto* poses : {&odometry_, &truth_}) poses->expect_restart(first);
  for (auto* images : {&depth_, &labels_}) images->expect_restart(first);
  info_.expect_restart(first);
  record_.follow_clock(step, first);
}

void EvaluatorComponent::count_contact(bool is_in_contact) {
  record_.count_contact(is_in_contact);
  context_.status().value("collisions", static_cast<std::uint64_t>(record_.collisions()));
}

void EvaluatorComponent::on_diagnostics(const diagnostic_msgs::msg::DiagnosticArray& message) {
  for (const auto& status : message.status()) {
    if (status.name() != context_.frame(status.hardware_id())) continue;  // another robot, or not a process of Lapis
    costs_.add(status);
  }
}

/// Ends the process when the map cannot be judged: the description is not valid, or it differs from the one for which
/// the references are built.
void EvaluatorComponent::on_map_description(const lapis_msgs::msg::MapDescription& message) {
  const std::string topic = topics::kMapDescription.name;
  auto description = messages::from_message(message);
  if (!description) return context_.fail(topic + ": " + description.reason);
  const std::string unlike = maps_.set_description(std::move(*description));
  if (!unlike.empty()) context_.fail(topic + ": the map is another one than before in this run: " + unlike);
}

void EvaluatorComponent::on_tile(const lapis_msgs::msg::VoxelTile& message) {
  mapping::TileIndex index;
  index.x = message.x();
  index.y = message.y();
  index.z = message.z();
  const auto result = maps_.mirror().apply_tile(message.epoch(), index, message.version(), message.data());
  if (result == mapping::TileResult::kDamaged) context_.status().count("damaged tiles");
}

void EvaluatorComponent::on_map_state(const lapis_msgs::msg::MapState& message) {
  mapping::MapState state;
  state.epoch = message.epoch();
  state.version = message.version();
  state.tiles = message.tiles();
  state.checksum = message.checksum();
  state.resolution_m = message.resolution_m();
  maps_.mirror().apply_state(state);
  maps_.set_map_session(message.session());
}

void EvaluatorComponent::on_planner_status(const lapis_msgs::msg::PlannerStatus& message) {
  planner_ = message;
  decisions_.add({message.decisions(), message.decision_time_s(), message.failures()});
}

void EvaluatorComponent::work(const runtime::Cycle& cycle) {
  while (next_frame(cycle)) {
  }
  has_ended_ |= cycle.is_final;
  const auto now = std::chrono::steady_clock::now();
  if (!planner_ || (!cycle.is_final && now - reported_ < kProgressPeriod)) return;
  reported_ = now;
  report_progress();
}

/// Logs the progress and publishes it with the heartbeat, for display during the run.
void EvaluatorComponent::report_progress() {
  find_truth();
  const std::string text = fmt::format("{}, {}: {}", how_far(), messages::state_name(*planner_), planner_->reason());
  spdlog::info("progress: {}", text);
  context_.heart().set_progress(text);
}

std::string EvaluatorComponent::how_far() const {
  if (timeline_.empty()) return tracked_.empty() ? "no frame of slam yet" : "no frame of slam can be judged yet";
  const TimelineRow& row = timeline_.back();
  const auto share = maps_.explored_share();
  return fmt::format("{:.0f} s, {:.0f} m3 explored{}, {:.1f} m driven, loops closed: {}", row.time_s,
                     row.explored_volume_m3.value_or(0.0), share ? fmt::format(" ({:.1f} %)", 100.0 * *share) : "",
                     row.path_length_m.value_or(0.0), loop_closures());
}

/// Joins and records the oldest frame that slam answered. Returns false when there is none or its partners may still
/// arrive.
bool EvaluatorComponent::next_frame(const runtime::Cycle& cycle) {
  if (tracked_.empty()) return false;
  const auto& [stamp, tracked] = tracked_.front();
  const auto partners = partners_of(tracked, cycle);
  if (!partners) return false;
  if (partners->truth != nullptr && !cycle.inputs_complete && !is_mount_known(*partners->truth, tracked)) return false;
  record(tracked, *partners);
  drop_until(stamp);
  return true;
}

/// The messages that belong to a frame; none while one of them may still arrive.
std::optional<EvaluatorComponent::Partners> EvaluatorComponent::partners_of(const Tracked& tracked,
                                                                            const runtime::Cycle& cycle) {
  using time::Match;
  const time::Time stamp = tracked_.front().first;
  const auto tolerance = time::Duration::from_seconds(config_.max_stamp_difference_s);
  const auto is_over = [&](const auto& input) { return cycle.inputs_complete || !input.has_publisher(); };
  if (depth_camera_.is_awaited() && !cycle.inputs_complete && !tracked_.is_full()) return std::nullopt;
  const auto waited = tracked_.newest().value_or(stamp) - stamp;
  const bool no_labels_come =
      is_over(labels_) || tracked_.is_full() || !waits_for_labels_ || waited.seconds() > config_.label_wait_s;
  Partners found;
  // slam's messages of one frame have the same stamp; for a frame without a pose, slam publishes no odometry.
  const bool no_odometry_comes = tier_of(tracked) == PoseTier::kNone || is_over(odometry_) || tracked_.is_full();
  const bool is_complete = odometry_.match(stamp, {}, no_odometry_comes, found.odometry) != Match::kWait &&
                           truth_.match(stamp, tolerance, is_over(truth_), found.truth) != Match::kWait &&
                           depth_.match(stamp, tolerance, is_over(depth_), found.depth) != Match::kWait &&
                           labels_.match(stamp, tolerance, no_labels_come, found.labels) != Match::kWait &&
                           info_.match(stamp, tolerance, is_over(info_), found.info) != Match::kWait;
  return is_complete ? std::optional(found) : std::nullopt;
}

/// Drops the frame, and all messages that no later frame can use.
void EvaluatorComponent::drop_until(time::Time stamp) {
  const auto tolerance = time::Duration::from_seconds(config_.max_stamp_difference_s);
  tracked_.drop_until(stamp);
  odometry_.drop_until(stamp);
  truth_.drop_until(stamp - tolerance);
  depth_.drop_until(stamp - tolerance);
  labels_.drop_until(stamp - tolerance);
  info_.drop_until(stamp - tolerance);
}

/// True when the camera's mount is known, without which the true pose of the base does not give that of the camera.
bool EvaluatorComponent::is_mount_known(const Odometry& truth, const Tracked& tracked) {
  const std::string& optical_frame = tracked.header().frame_id();
  if (static_transforms_.find(truth.child_frame_id(), optical_frame)) return true;
  if (context_.rate_limit().pass("mount")) {
    spdlog::warn("waiting: no transform from {} to {} on /tf_static", truth.child_frame_id(), optical_frame);
  }
  return false;
}

void EvaluatorComponent::record(const Tracked& tracked, const Partners& partners) {
  newest_ = std::chrono::steady_clock::now();
  if (!began_) began_ = newest_;
  FrameRecord frame;
  frame.stamp = messages::from_message(tracked.header().stamp());
  frame.session = tracked.session();
  frame.T_map_camera = pose_of(tracked);
  if (frame.T_map_camera) frame.tier = tier_of(tracked);
  if (tracked.is_keyframe()) frame.keyframe_id = tracked.keyframe_id();
  if (partners.odometry != nullptr) frame.position_sigma_m = position_sigma_m(*partners.odometry);
  if (partners.truth != nullptr) frame.T_world_camera = true_camera_pose(*partners.truth, tracked.header().frame_id());
  const bool is_judged = record_.add(frame);
  maps_.set_judged_session(*record_.session());
  context_.status().value("frames", static_cast<std::uint64_t>(record_.frames_judged()));
  if (!is_judged) context_.status().count("frames not judged: slam began a new map");
  if (is_judged && frame.T_map_camera && frame.T_world_camera && partners.depth != nullptr &&
      partners.info != nullptr) {
    add_to_references(*record_.T_map_world() * *frame.T_world_camera, *partners.depth, partners.labels, *partners.info);
  }
  add_timeline_row();
}

/// Pose of the camera in the map; none when slam had no pose.
std::optional<geometry::Pose> EvaluatorComponent::pose_of(const Tracked& tracked) {
  if (tier_of(tracked) == PoseTier::kNone) return std::nullopt;
  const auto T_map_keyframe = messages::from_message(tracked.keyframe_pose());
  const auto T_keyframe_camera = messages::from_message(tracked.pose_in_keyframe());
  if (T_map_keyframe && T_keyframe_camera) return *T_map_keyframe * *T_keyframe_camera;
  context_.status().count("tracked frames without a valid pose");
  return std::nullopt;
}

/// Loads the scene's ground truth when it is available. Returns the problem with it, or an empty text.
std::string EvaluatorComponent::find_truth() {
  return record_.T_map_world() ? maps_.find_truth(*record_.T_map_world()) : "";
}

std::optional<geometry::Pose> EvaluatorComponent::true_camera_pose(const Odometry& truth,
                                                                   const std::string& optical_frame) {
  const auto T_world_base = messages::from_message(truth.pose().pose());
  const auto T_base_camera = static_transforms_.find(truth.child_frame_id(), optical_frame);
  if (!T_world_base || !T_base_camera) return std::nullopt;
  return *T_world_base * *T_base_camera;
}

void EvaluatorComponent::add_to_references(const geometry::Pose& T_map_camera, const Image& depth, const Image* labels,
                                           const Info& info) {
  const auto refuse = [this](const std::string& why) {
    context_.status().count("frames not in the reference: " + why);
  };
  const auto depth_m = depth_camera_.convert(depth, info);
  if (!depth_m) return refuse(depth_m.reason);
  const auto camera = messages::lens_camera(depth_camera_.corrected(info));
  if (!camera) return refuse(camera.reason);
  geometry::LabelImage ids;
  if (labels != nullptr) {
    auto converted = messages::to_labels(*labels);
    if (converted && messages::size_problem("label", converted->width, converted->height, camera->pinhole).empty()) {
      rectifier_.of(*camera).rectify(*converted);
      ids = std::move(*converted);
    }
  }
  const std::string problem = maps_.add_reference_frame(camera->pinhole, *depth_m, ids, T_map_camera);
  if (!problem.empty()) refuse(problem);
}

void EvaluatorComponent::add_timeline_row() {
  const time::Time stamp = record_.newest();
  if (timeline_stamp_ && (stamp - *timeline_stamp_).seconds() < config_.timeline_period_s) return;
  timeline_stamp_ = stamp;
  const FrameRow& frame = record_.frames().back();
  TimelineRow row;
  row.time_s = frame.time_s;
  row.tier = frame.tier;
  row.path_length_m = frame.path_length_m;
  row.position_error_m = frame.position_error_m;
  row.position_sigma_m = frame.position_sigma_m;
  if (planner_) row.planner_state = messages::state_name(*planner_);
  maps_.write_to(row);
  timeline_.push_back(row);
}

std::int64_t EvaluatorComponent::loop_closures() const {
  return std::count_if(graph_.edges().begin(), graph_.edges().end(), [](const auto& edge) {
    return edge.type() == lapis_msgs::msg::PoseGraphEdge_Constants::TYPE_LOOP_CLOSURE;
  });
}

RunMetrics EvaluatorComponent::metrics() const {
  RunMetrics m;
  record_.write_to(m, keyframes_of(graph_), static_cast<std::int64_t>(info_.missed()), has_ended_);
  m.loop_closures = loop_closures();
  if (began_) m.wall_time_s = std::chrono::duration<double>(newest_ - *began_).count();
  if (m.wall_time_s.value_or(0.0) > 0.0) m.real_time_factor = *m.duration_s / *m.wall_time_s;
  costs_.write_to(m);
  decisions_.write_to(m);
  if (planner_) {
    m.planner_state = messages::state_name(*planner_);
    m.planner_reason = planner_->reason();
  }
  m.time_to_80_s = time_to_reach(timeline_, 0.8);
  m.time_to_90_s = time_to_reach(timeline_, 0.9);
  m.stalled_share = stalled_share(timeline_, 0.9);
  maps_.write_to(m, record_.T_map_world().has_value());
  return m;
}

void EvaluatorComponent::write_files(const RunMetrics& m) const {
  const std::filesystem::path folder(config_.output_dir);
  trajectory::write_trajectory(folder / "trajectory_estimate.txt", record_.estimate(),
                               "camera optical frame in the map, as published");
  trajectory::write_trajectory(folder / "trajectory_ground_truth.txt", record_.truth_in_map(),
                               "true camera optical frame, in the map by the first true pose");
  files::replace_text(folder / "timeline.csv", to_csv(timeline_));
  files::replace_text(folder / "frames.csv", to_csv(record_.frames()));
  files::replace_text(folder / "metrics.json", to_json(m));
  files::replace_text(folder / "metrics.txt", format_table(m));
  if (record_.T_map_world()) maps_.save_reference(folder / "reference_map.lapis");
}

void EvaluatorComponent::finish() {
  waits_for_labels_ = false;
  while (next_frame({})) {
  }
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
  if (record_.is_empty()) {
    spdlog::warn("no frame came; nothing is written");
    return;
  }
  const runtime::LongWork work(context_.heart(), "judges the run", kLongestJudging_s);
  if (const auto problem = find_truth(); !problem.empty()) {
    spdlog::warn("ground truth of the scene is left out: {}", problem);
  }
  maps_.add_shares(timeline_);
  mark_stalls(timeline_);
  const RunMetrics m = metrics();
  write_files(m);
  std::cout << format_table(m) << std::flush;
  if (!config_.figures) return;
  if (context_.is_in_a_hurry()) return spdlog::info("figures are left out; {}", figures_command(config_.output_dir));
  draw_figures(config_.output_dir, [this] { return context_.is_in_a_hurry(); });
}

}  // namespace lapis::evaluator

template int lapis::runtime::run_component<lapis::evaluator::EvaluatorComponent>(int argc, char** argv);
