#include "planner/planner_component.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <utility>

#include "common/files/atomic_file.hpp"
#include "common/messages/landmarks.hpp"
#include "common/messages/map_description.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/planner_views.hpp"
#include "common/topics/services.hpp"
#include "common/topics/slam.hpp"
#include "planner/replay_tool.hpp"

namespace lapis::planner {
namespace {

constexpr double kFarewell_s = 1.0;
constexpr time::Duration kLongestLead =
    time::Duration::from_seconds(1.0);  // of messages that overtake the first frame of a session
constexpr const char* kSituations = "situations";

Tracking tracking_of(const lapis_msgs::msg::TrackedFrame& frame) {
  using namespace lapis_msgs::msg::TrackedFrame_Constants;
  if (frame.state() == STATE_TRACKING) return Tracking::kTracking;
  return frame.state() == STATE_DEAD_RECKONING ? Tracking::kDeadReckoning : Tracking::kLost;
}

}  // namespace

void PlannerComponent::add_options(CLI::App& app, Config& config) {
  app.add_option("--replay", config.replay,
                 "decide a recorded situation again (planner.record_situations_every), print the candidates, and exit");
}

std::optional<int> PlannerComponent::run_tool(const Config& config) { return run_replay(config); }

/// A configuration that breaks these rules would leave the planner nothing to do, or let it expect loops everywhere.
config::Rules PlannerComponent::rules(const Config& config) {
  const ViewpointConfig& viewpoints = config.decision.viewpoints;
  const HallucinationConfig& hallucination = config.decision.hallucination;
  const GridConfig& grid = config.surroundings.grid;
  const robot::RobotDescription& robot = config.robot;
  const double comfort_m = config.decision.path.comfort_m;
  return {{viewpoints.min_distance_m < viewpoints.max_distance_m,
           "planner.viewpoints.min_distance_m has to be less than planner.viewpoints.max_distance_m"},
          {hallucination.impossible_landmarks < hallucination.certain_landmarks,
           "planner.hallucination.impossible_landmarks has to be less than planner.hallucination.certain_landmarks"},
          {viewpoints.max_distance_m <= robot.sensing_range_m,
           "planner.viewpoints.max_distance_m has to be at most robot.sensing_range_m"},
          {config.explorer.slowest_m_s < robot.max_speed_m_s,
           "planner.slowest_m_s has to be less than robot.max_speed_m_s"},
          {robot.obstacle_min_height_m < robot.obstacle_max_height_m,
           "robot.obstacle_min_height_m has to be less than robot.obstacle_max_height_m"},
          {comfort_m > robot.radius_m + grid.margin_m,
           "planner.path.comfort_m has to be more than robot.radius_m and planner.grid.margin_m together"},
          {comfort_m <= grid.max_clearance_m, "planner.path.comfort_m has to be at most planner.grid.max_clearance_m"},
          {config.then == "none" || !config.explorer.returns_home,
           "planner.then and planner.returns_home exclude each other"},
          {config.record_situations_every == 0 || !config.output_dir.empty(),
           "planner.record_situations_every needs planner.output_dir"}};
}

PlannerComponent::PlannerComponent(const Config& config, runtime::Context& context)
    : config_(completed(config)), context_(context), map_frame_(context.frame("map")),
      base_frame_(context.frame("base_link")), view_(view_config(config_)),
      T_base_camera_(geometry::T_base_camera(robot::camera_mount(config_.robot.camera))),
      path_(context.advertise(topics::kPlannerPath)), candidates_(context.advertise(topics::kCandidates)),
      markers_(context.advertise(topics::kPlannerMarkers)), status_(context.advertise(topics::kPlannerStatus)),
      explorer_(config_.explorer), ledger_(config_.explorer.memory.radius_m) {
  if (!config_.output_dir.empty()) {
    files::require_writable_folder(config_.output_dir, "planner.output_dir");
    log_.emplace((std::filesystem::path(config_.output_dir) / DecisionLog::kFile).string(), config_.compared_methods,
                 config_.surroundings.compared_priors);
    plan_.emplace((std::filesystem::path(config_.output_dir) / DecisionPlan::kFile).string());
  }
  if (config_.record_situations_every > 0)
    files::require_writable_folder((std::filesystem::path(config_.output_dir) / kSituations).string(),
                                   "planner.output_dir");
  context.subscribe(topics::kMapDescription, [this](const auto& m) { set_description(m); });
  context.subscribe(topics::kVoxelTiles, [this](const auto& m) { add_tile(m); });
  context.subscribe(topics::kMapState, [this](const auto& m) { set_map_state(m); });
  context.subscribe(topics::kObstacles, [this](nav_msgs::msg::OccupancyGrid& m) { set_obstacles(std::move(m)); });
  context.subscribe(topics::kProvisionalArea,
                    [this](nav_msgs::msg::OccupancyGrid& m) { set_provisional_area(std::move(m)); });
  context.subscribe(topics::kPoseGraph, [this](const auto& m) { set_graph(m); });
  context.subscribe(topics::kLandmarks, [this](const auto& m) { add_landmarks(m); });
  context.subscribe(topics::kLandmarkState,
                    [this](const auto& m) { landmarks_.apply_state(messages::from_message(m)); });
  context.subscribe(topics::kTrackedFrame, [this](const auto& m) { note_frame(m); });
  context.subscribe(topics::kSlamStatus, [this](const auto& m) { note_slam(m); });
  context.subscribe(topics::kSlamOdometry, [this](const auto& m) { set_pose(m); });
  context.subscribe(topics::kControllerStatus, [this](const auto& m) { note_controller(m); });
  context.subscribe(topics::kGoal, [this](const auto& m) { set_goal(m); });
  serve();
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
  if (config_.autostart) explorer_.start();
}

void PlannerComponent::reconfigure(const Config& config) {
  config_ = completed(config);
  explorer_.reconfigure(config_.explorer);
}

void PlannerComponent::serve() {
  const auto answer = [](bool is_done, const std::string& message) {
    std_srvs::srv::Trigger_Response response;
    response.success(is_done);
    response.message(message);
    return response;
  };
  const auto on = [this, answer](const auto& service, void (Explorer::*action)(), const std::string& message) {
    context_.serve(service, [this, answer, action, message](const auto&) {
      (explorer_.*action)();
      return answer(true, message);
    });
  };
  on(topics::kStartExploring, &Explorer::start, "exploring");
  on(topics::kStopExploring, &Explorer::stop, "stopped");
  on(topics::kReturnHome, &Explorer::return_home, "returning");
  context_.serve(topics::kPauseExploring, [this, answer](const auto&) {
    return explorer_.pause() ? answer(true, "paused") : answer(false, "nothing to pause: " + explorer_.reason());
  });
}

/// Fails the component when the description is not valid, because the counts of the map cannot be read without it.
void PlannerComponent::set_description(const lapis_msgs::msg::MapDescription& message) {
  auto description = messages::from_message(message);
  if (!description) return context_.fail(std::string(topics::kMapDescription.name) + ": " + description.reason);
  description_ = std::move(*description);
}

void PlannerComponent::add_tile(const lapis_msgs::msg::VoxelTile& message) {
  const mapping::TileIndex index{message.x(), message.y(), message.z()};
  const auto result = map_.apply_tile(message.epoch(), index, message.version(), message.data());
  if (result == mapping::TileResult::kDamaged) drop("tile", "it cannot be decoded");
}

void PlannerComponent::set_map_state(const lapis_msgs::msg::MapState& message) {
  const auto state = to_core(message);
  if (!state) return drop("map state", state.reason);
  map_.apply_state(*state);
}

void PlannerComponent::add_landmarks(const lapis_msgs::msg::LandmarkTile& message) {
  auto tile = messages::from_message(message);
  if (!tile) return drop("landmarks", tile.reason);
  landmarks_.apply_tile(message.epoch(), std::move(*tile));
}

void PlannerComponent::set_graph(const lapis_msgs::msg::PoseGraph& message) {
  auto graph = to_core(message);
  if (!graph) return drop("pose graph", graph.reason);
  graph_ = std::move(*graph);
}

void PlannerComponent::set_obstacles(nav_msgs::msg::OccupancyGrid message) {
  if (message.header().frame_id() != map_frame_) return drop("obstacles", "they are not in " + map_frame_);
  obstacles_ = std::move(message);
}

void PlannerComponent::set_provisional_area(nav_msgs::msg::OccupancyGrid message) {
  if (message.header().frame_id() != map_frame_) return drop("provisional area", "it is not in " + map_frame_);
  provisional_area_ = std::move(message);
}

/// Nothing that is known is in the map frame of the new session, except messages that have overtaken its first frame,
/// because messages of one instant arrive in any order. These are recognised by their stamps. When slam restarts at the
/// frame at which it stopped, an old pose is kept, too, but slam's new pose follows at once. The provisional area is
/// published only when it changes; before the first session there is no other area, so it is kept.
void PlannerComponent::begin_session(std::int64_t session, time::Time first_frame) {
  const auto is_of_session = [first_frame](time::Time stamp) {
    const time::Duration later = stamp - first_frame;
    return later >= time::Duration{} && later < kLongestLead;
  };
  const bool is_first = std::exchange(session_, session) == 0;
  worker_.discard();
  if (!is_of_session(robot_stamp_)) robot_.reset();
  if (obstacles_ && !is_of_session(messages::from_message(obstacles_->header().stamp()))) obstacles_.reset();
  if (provisional_area_ && !is_first && !is_of_session(messages::from_message(provisional_area_->header().stamp())))
    provisional_area_.reset();
  clock_ = {};
  surroundings_.reset();
  surroundings_state_.reset();
  decision_ = {};
  ledger_ = PathLedger(config_.explorer.memory.radius_m);
  knowledge_.reset();
  known_graph_ = {};
  recorded_graph_.reset();
  explorer_.forget_map();
}

void PlannerComponent::note_frame(const Tracked& frame) {
  const time::Time stamp = messages::from_message(frame.header().stamp());
  if (frame.session() != session_) begin_session(frame.session(), stamp);
  context_.status().value("frames", ++frames_);
  note_stamp(stamp);
  tracking_ = tracking_of(frame);
  drift_m_ = frame.drift_m();
  slam_reason_ = frame.reason();
  if (tracking_ == Tracking::kLost) robot_.reset();
}

/// The controller's stamps, which are compared with that of the path, follow a clock that was set, too.
void PlannerComponent::note_stamp(time::Time stamp) {
  if (!context_.is_free()) return clock_.believe(stamp);
  const auto step = clock_.advance(stamp, time::Arrival::clock::now());
  if (!step) return;
  path_stamp_ = path_stamp_ + *step;
  context_.status().count("slam frame: the clock of its source was set");
}

/// Once there are frames, they contain the reason themselves.
void PlannerComponent::note_slam(const lapis_msgs::msg::SlamStatus& message) {
  if (frames_ == 0) slam_reason_ = message.reason();
}

void PlannerComponent::set_pose(const nav_msgs::msg::Odometry& message) {
  if (message.header().frame_id() != map_frame_ || message.child_frame_id() != base_frame_)
    return drop("pose", "it is not of " + base_frame_ + " in " + map_frame_);
  auto pose = to_core(message.pose().pose());
  if (!pose) return drop("pose", pose.reason);
  robot_ = *pose;
  robot_stamp_ = messages::from_message(message.header().stamp());
  last_robot_ = *robot_;
  position_variance_m2_ = position_variance_m2(message.pose().covariance());
}

void PlannerComponent::set_goal(const geometry_msgs::msg::PoseStamped& message) {
  if (message.header().frame_id() != map_frame_) return drop("goal", "it is not in " + map_frame_);
  const auto place = to_destination(message.pose(), last_robot_);
  if (!place) return drop("goal", place.reason);
  spdlog::info("drives to ({:.2f}, {:.2f})", place->pose.p_map.x(), place->pose.p_map.y());
  explorer_.go_to(*place);
}

void PlannerComponent::note_controller(const lapis_msgs::msg::ControllerStatus& message) {
  const bool is_of_this_path = messages::from_message(message.header().stamp()) > path_stamp_;
  is_blocked_ = is_of_this_path && message.state() == lapis_msgs::msg::ControllerStatus_Constants::STATE_BLOCKED;
}

void PlannerComponent::work(const runtime::Cycle& cycle) {
  if (cycle.is_final) return worker_.discard();
  take_decision(cycle.inputs_complete);
  if (!worker_.is_busy() && frames_ > 0) {
    refresh();
    if (explorer_.step(report(), surroundings_ ? &*surroundings_ : nullptr)) begin_decision();
  }
  publish();
}

/// Waits for a late decision in lock-step only: in wall-clock time the robot would stop because no status arrives.
void PlannerComponent::take_decision(bool waits) {
  auto output = worker_.take(frames_, waits);
  if (!output) return;
  knowledge_ = std::move(output->knowledge);
  decision_time_s_ = output->time_s;
  decision_ = std::move(output->decision);
  const Decision& decision = decision_;
  ++decisions_;
  context_.status().value("decisions", decisions_);
  if (!decision.problem.empty()) drop("pose graph", decision.problem);
  const bool is_taken = deciding_method_ == method_of_state() && explorer_.take(decision, report());
  candidates_.publish(to_message(decision, decisions_, deciding_method_, header()));
  const Decision* driven = is_taken && decision.chosen ? &decision : nullptr;
  if (driven != nullptr) driven_by_ = decision.explanation;
  const Learnt learnt{surroundings_->information_nats(), knowledge_ ? &knowledge_->graph : nullptr};
  write_down(decision, ledger_.note(driven, learnt, last_robot_, clock_.now()));
}

void PlannerComponent::write_down(const Decision& decision, const std::optional<DrivenPath>& ended) {
  if (log_ && !log_->write(decision, ended, decisions_, deciding_method_, clock_.now())) {
    spdlog::error("{}/{} cannot be written; exploration continues without it", config_.output_dir, DecisionLog::kFile);
    log_.reset();
  }
  const auto problem = plan_ ? plan_->write(decision, *surroundings_, decisions_) : std::nullopt;
  if (!problem) return;
  spdlog::error("{}; exploration continues without it", *problem);
  plan_.reset();
}

/// Applies what has changed. Must not be called while a decision reads it.
void PlannerComponent::refresh() {
  if (is_map_readable()) update_map();
  if (surroundings_) update_obstacles();
  if (surroundings_) update_provisional_area();
}

/// True when the map is of the current session and the newest description belongs to it.
bool PlannerComponent::is_map_readable() {
  if (map_.map() == nullptr || map_.state()->session != session_) return false;
  const mapping::MapState& state = *map_.state();
  if (!description_ || description_->epoch != state.epoch) return false;
  if (description_->resolution_m == state.resolution_m) return true;
  context_.fail(std::string(topics::kMapDescription.name) + ": resolution_m is " +
                std::to_string(description_->resolution_m) + " there and " + std::to_string(state.resolution_m) +
                " on " + topics::kMapState.name);
  return false;
}

void PlannerComponent::update_map() {
  const mapping::MapState& state = *map_.state();
  const mapping::SensorModel& model = description_->sensor_model;
  const bool is_other_map = surroundings_state_ && surroundings_state_->resolution_m != state.resolution_m;
  if (!surroundings_ || is_other_map || surroundings_model_ != model) {
    spdlog::info("map of {} m voxels: fusion {}, prior_occupied {}, {} classes", state.resolution_m, model.fusion,
                 model.prior_occupied, model.class_count);
    surroundings_.emplace(config_.surroundings, model, state.resolution_m);
    ledger_ = PathLedger(config_.explorer.memory.radius_m);
    surroundings_model_ = model;
    map_.take_changed_blocks();
    surroundings_->update_map(*map_.map(), map_.map()->sorted_blocks());
  } else if (surroundings_state_->version != state.version || surroundings_state_->epoch != state.epoch) {
    surroundings_->update_map(*map_.map(), map_.take_changed_blocks());
  }
  surroundings_state_ = state;
}

void PlannerComponent::update_obstacles() {
  if (!obstacles_) return;
  const time::Time seen_at = clock_.of(messages::from_message(obstacles_->header().stamp()));
  const bool is_of_other_clock = seen_at - clock_.now() > kLongestLead;
  if (is_of_other_clock) return;  // a later frame, or a later grid, shows that the clock was set
  const auto grid = to_core(*obstacles_);
  if (!grid) {
    drop("obstacles", grid.reason);
  } else if (!surroundings_->update_obstacles(*grid, seen_at)) {
    drop("obstacles", "resolution or size of the grid");
  }
  obstacles_.reset();
}

void PlannerComponent::update_provisional_area() {
  if (!provisional_area_) return;
  const auto area = to_core(*provisional_area_);
  if (!area) {
    drop("provisional area", area.reason);
  } else if (!surroundings_->set_provisional_area(*area)) {
    drop("provisional area", "its cells are not those of the map");
  }
  provisional_area_.reset();
}

Report PlannerComponent::report() const {
  const bool is_map_behind = surroundings_state_ && surroundings_state_->frames_off > 0;
  return {clock_.now(), robot_, tracking_, is_blocked_, drift_m_, is_map_behind};
}

/// Why the mission is in its state; without a pose, also what slam lacks.
std::string PlannerComponent::reason() const {
  const bool is_lacking = tracking_ == Tracking::kLost && !slam_reason_.empty();
  return is_lacking ? explorer_.reason() + "; slam: " + slam_reason_ : explorer_.reason();
}

/// reason(); while the robot drives to a goal, also why that goal was chosen.
std::string PlannerComponent::reason_with_choice() const {
  const bool has_goal = explorer_.has_goal() && !driven_by_.empty();
  return has_goal ? reason() + " (" + driven_by_ + ")" : reason();
}

std::string PlannerComponent::method_of_state() const {
  return is_consolidating() ? "then_" + config_.then : config_.method;
}

PlannerComponent::GraphVersions PlannerComponent::versions_of_graph() const {
  const auto landmarks = landmarks_.state().value_or(mapping::LandmarkState{});
  return {graph_->session, graph_->version, landmarks.epoch, landmarks.graph_version};
}

void PlannerComponent::begin_decision() {
  DecisionInput input;
  input.surroundings = &*surroundings_;
  input.view = &view_;
  input.T_base_camera = T_base_camera_;
  input.robot = *robot_;
  input.memory = explorer_.memory(clock_.now());
  input.config = config_.decision;
  deciding_method_ = method_of_state();
  if (is_consolidating()) input.config.method = config_.consolidation;
  input.knowledge = knowledge_;
  const bool has_edges = graph_ && graph_->session == session_ && !graph_->edges.empty();
  if (has_edges && versions_of_graph() != known_graph_) {
    input.graph = graph_;
    input.position_variance_m2 = position_variance_m2_;
    if (landmarks_.state() && landmarks_.state()->session == graph_->session) input.landmarks = landmarks_.tiles();
    known_graph_ = versions_of_graph();
  }
  if (config_.record_situations_every > 0) record(input);
  worker_.start(std::move(input), frames_ + static_cast<std::uint64_t>(config_.decision_latency_frames));
}

/// Records before the decision is made, because the map may have changed afterwards.
void PlannerComponent::record(const DecisionInput& input) {
  if (input.graph)
    recorded_graph_ = {input.graph->keyframes, input.graph->edges, input.position_variance_m2, input.landmarks};
  const std::uint64_t number = decisions_ + 1;
  const bool is_wanted = number % static_cast<std::uint64_t>(config_.record_situations_every) == 0;
  if (!is_wanted || is_consolidating()) return;  // a recorded situation does not contain visited places
  const mapping::MapState &shown = *surroundings_state_, &newest = *map_.state();
  if (shown.epoch != newest.epoch || shown.version != newest.version) return;  // the newest map cannot be read yet
  const RecordedSituation situation{
      {*map_.map(),
       surroundings_model_,
       description_->labels,
       {{"decision", std::to_string(number)}, {"stamp", to_string(clock_.stamp())}, {"method", config_.method}}},
      surroundings_->grid().marks(),
      input.robot,
      input.memory,
      recorded_graph_};
  const auto file = std::filesystem::path(config_.output_dir) / kSituations / (std::to_string(number) + ".lapis");
  if (const auto problem = files::replace_file(file.string(), encode_situation(situation)))
    spdlog::error("{}", *problem);
}

void PlannerComponent::publish() {
  if (explorer_.path_number() != published_path_) {
    published_path_ = explorer_.path_number();
    path_stamp_ = clock_.stamp();
    is_blocked_ = false;
    path_.publish(to_message(explorer_.path(), header(explorer_.is_turn() ? base_frame_ : map_frame_)));
  }
  publish_markers();
  publish_status();
}

/// Publishes the markers of each decision while there are readers, and at once when a reader appears.
void PlannerComponent::publish_markers() {
  const bool has_new_reader = markers_.matched() > std::exchange(marker_readers_, markers_.matched());
  const bool is_new = std::exchange(shown_decision_, decisions_) != decisions_;
  if (markers_.matched() == 0 || !surroundings_ || !(is_new || has_new_reader)) return;
  markers_.publish(to_markers(surroundings_->frontiers(), surroundings_->grid(), decision_, header()));
}

/// Publishes with each frame, because the controller stops when no status arrives.
void PlannerComponent::publish_status() {
  const bool is_new_lack = frames_ == 0 && slam_reason_ != reported_lack_;
  const bool has_changed =
      is_new_lack || explorer_.state() != reported_state_ || explorer_.reason() != reported_reason_;
  const bool has_decided = decisions_ != reported_decisions_;  // the time of each decision is published
  if (reported_at_ == clock_.stamp() && !has_changed && !has_decided) return;
  if (has_changed) spdlog::info("{}", reason());
  reported_at_ = clock_.stamp();
  reported_state_ = explorer_.state();
  reported_reason_ = explorer_.reason();
  reported_lack_ = slam_reason_;
  reported_decisions_ = decisions_;
  lapis_msgs::msg::PlannerStatus message;
  message.header(header());
  message.state(to_message(explorer_.state()));
  message.reason(reason_with_choice());
  message.explored_volume_m3(surroundings_ ? surroundings_->explored_volume_m3() : 0.0);
  message.decision_time_s(decision_time_s_);
  message.decisions(decisions_);
  message.failures(explorer_.failures());
  status_.publish(message);
}

/// @param reason one of a few texts, because each is a counter
void PlannerComponent::drop(const std::string& what, const std::string& reason) {
  context_.status().count(what + " dropped: " + reason);
  if (context_.rate_limit().pass(what + reason)) spdlog::warn("{} dropped: {}", what, reason);
}

std_msgs::msg::Header PlannerComponent::header(const std::string& frame) const {
  return messages::header(clock_.stamp(), frame);
}

/// Stops the robot first, because a decision may take long.
void PlannerComponent::finish() {
  path_.publish(to_message(std::vector<Pose2>{}, header()));
  path_.wait_until_acknowledged(kFarewell_s);
  worker_.discard();
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
}

}  // namespace lapis::planner

template int lapis::runtime::run_component<lapis::planner::PlannerComponent>(int argc, char** argv);
