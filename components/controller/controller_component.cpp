#include "controller/controller_component.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <string>
#include <utility>

#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/camera.hpp"
#include "common/topics/controller.hpp"
#include "common/topics/map.hpp"
#include "common/topics/planner.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"

namespace lapis::controller {
namespace {

constexpr double kFarewell_s = 1.0;
constexpr double kLeastOdometry_hz = 10.0;
constexpr std::size_t kWaitingFrames = 10;
constexpr std::size_t kWaitingInfos = 64;  // on a network they are ahead of their images by half a second
constexpr time::Duration kStatusPeriod{1'000'000'000};
constexpr time::Duration kForgottenPerImage{1'000'000};  // of the least delay, when images come later than before
constexpr time::Duration kOdometrySilence{300'000'000};  // after a start: slam begins a new track after such a gap

time::Time steady_now() {
  const auto since_boot = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration_cast<std::chrono::nanoseconds>(since_boot).count()};
}

}  // namespace

/// Without these conditions, the robot would not see obstacles in its path, or a turn would count as no progress.
config::Rules ControllerComponent::rules(const Config& config) {
  const LocalMapConfig& map = config.method.local_map;
  const FanConfig& fan = config.method.fan;
  const robot::RobotDescription& robot = config.robot;
  const double slowest_turn_rad_s =
      std::min({robot.max_turn_rate_rad_s, config.method.weak_turn_rad_s, config.method.turn_limit_rad_s});
  return {
      {fan.groups % 2 == 1, "controller.fan.groups has to be odd"},
      {fan.branches % 2 == 1, "controller.fan.branches has to be odd"},
      {map.min_height_m < robot.obstacle_max_height_m,
       "controller.local_map.min_height_m has to be less than robot.obstacle_max_height_m"},
      {map.range_m >= fan.length_m + robot.radius_m + fan.margin_m,
       "controller.local_map.range_m has to be at least controller.fan.length_m, robot.radius_m and "
       "controller.fan.margin_m together"},
      {config.method.progress_timeout_s > std::numbers::pi / slowest_turn_rad_s,
       "controller.progress_timeout_s has to be longer than half a turn at robot.max_turn_rate_rad_s, at "
       "controller.turn_limit_rad_s and at controller.weak_turn_rad_s takes"},
      {!config.publish_odometry || robot.camera.rate_hz >= kLeastOdometry_hz,
       "controller.publish_odometry needs a robot.camera.rate_hz of at least 10: with less, slam takes each reading "
       "for the first of a new track"}};
}

ControllerComponent::ControllerComponent(const Config& config, runtime::Context& context)
    : config_(completed(config)), context_(context), map_frame_(context.frame("map")),
      odom_frame_(context.frame("odom")), base_frame_(context.frame("base_link")),
      controller_(config_.method, limits_of(config_.robot)), motion_(drive_model(config_.robot)),
      command_(context.advertise(topics::kCommand)), local_path_(context.advertise(topics::kLocalPath)),
      status_(context.advertise(topics::kControllerStatus)),
      pose_(context, topics::kSlamOdometry, "pose", kWaitingFrames),
      tolerance_(time::Duration::from_seconds(config.max_stamp_difference_s)),
      depth_(runtime::depth_input(context, kWaitingFrames)),
      info_(context, topics::kDepthInfo, "camera info", kWaitingInfos) {
  if (config_.publish_odometry) {
    odometry_ = &context.advertise(topics::kWheelOdometry);
    transforms_ = &context.advertise(topics::kTransforms);
  }
  depth_.require();
  info_.require();
  depth_.on_arrival([this](time::Time stamp) { note_camera(stamp); });
  depth_.on_restart([this] { motion_ = CommandOdometry(drive_model(config_.robot)); });
  depth_.on_clock_set([this](time::Duration step) { follow_clock(step); });
  pose_.on_clock_set([this](time::Duration) {
    depth_.expect_restart(pose_.front().first);
    info_.expect_restart(pose_.front().first);
    tolerance_.begin_anew();
  });
  context.subscribe(topics::kStaticTransforms, [this](const auto& m) { add_mount(m); });
  context.subscribe(topics::kTrackedFrame, [this](const auto& m) { note_frame(m); });
  context.subscribe(topics::kPlannerPath, [this](Path& m) { path_ = std::move(m); });
  context.subscribe(topics::kPlannerStatus, [this](const auto&) { has_planner_spoken_ = true; });
  context.subscribe(topics::kOccupancyGrid, [this](OccupancyGrid& m) { plan_ = std::move(m); });
  context.subscribe(topics::kObstacles, [this](OccupancyGrid& m) { obstacles_ = std::move(m); });
  context.every(1.0 / config_.rate_hz, [this] { is_due_ = true; });
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
}

void ControllerComponent::reconfigure(const Config& config) {
  config_ = completed(config);
  controller_.reconfigure(config_.method);
}

/// The obstacles that the camera has seen and the ages of all inputs stay what they are. The step is known to the
/// jitter of delays only, and time must not go back.
void ControllerComponent::follow_clock(time::Duration step) {
  camera_ahead_ = camera_stamp_ - steady_now();
  const time::Duration steps{clock_steps_.nanoseconds + step.nanoseconds};
  clock_steps_ = std::min(steps, depth_.front().first - seen_at_);
}

/// The camera's clock is taken to run like the steady one, and images to be late rather than early.
void ControllerComponent::note_camera(time::Time stamp) {
  camera_stamp_ = stamp;
  const time::Duration ahead = stamp - steady_now();
  if (!context_.is_free()) {
    camera_ahead_.reset();
  } else if (camera_ahead_) {
    camera_ahead_ = std::max(ahead, time::Duration{camera_ahead_->nanoseconds - kForgottenPerImage.nanoseconds});
  } else {
    camera_ahead_ = ahead;
  }
}

/// False while one of two streams has noticed that their clock was set, and the other one has not.
bool ControllerComponent::is_of_camera(time::Time stamp) const {
  return camera_stamp_.nanoseconds == 0 || abs(stamp - camera_stamp_) <= time::kRestartGap;
}

/// In lock-step, time is that of the frames, and each tick has one command. Otherwise the age of an input is the time
/// since its arrival, because a robot must stop in time even when the clock that stamps its inputs has stopped.
void ControllerComponent::work(const runtime::Cycle& cycle) {
  const time::Time now = cycle.inputs_complete ? camera_stamp_ : steady_now();
  take_inputs(cycle, now);
  if (cycle.is_final) return publish({State::kIdle, "the run is over", {}, 0.0, {}}, now);
  if (cycle.inputs_complete || std::exchange(is_due_, false)) publish(controller_.step(now), now);
}

void ControllerComponent::take_inputs(const runtime::Cycle& cycle, time::Time now) {
  if (camera_stamp_.nanoseconds != 0) {
    seen_at_ = camera_stamp_ - clock_steps_;
    controller_.note_camera(seen_at_, now);
  }
  while (next_frame(cycle, now)) {
  }
  take_map(now);
  if (path_ || has_planner_spoken_) controller_.note_planner(now);
  has_planner_spoken_ = false;
  if (path_) take_path(*path_);
  path_.reset();
}

/// Joins the oldest pose with its depth image and camera info. Returns false when there is no pose, or when these may
/// still arrive.
bool ControllerComponent::next_frame(const runtime::Cycle& cycle, time::Time now) {
  using time::Match;
  if (pose_.empty()) return false;
  const auto& [stamp, odometry] = pose_.front();
  const bool is_last_chance = cycle.inputs_complete || pose_.is_full();
  const auto known = tolerance_.of(stamp, pose_.second());
  const auto tolerance = known.value_or(is_last_chance ? time::StampTolerance::kLargest : time::Duration{});
  Image* depth = nullptr;
  Info* info = nullptr;
  const auto depth_match = depth_.match(stamp, tolerance, is_last_chance, depth);
  const auto info_match = info_.match(stamp, tolerance, is_last_chance, info);
  if (depth_match == Match::kWait || info_match == Match::kWait) return false;
  const bool is_whole = depth != nullptr && info != nullptr;
  if (!is_whole && !known && !is_last_chance) return false;  // the next pose gives the tolerance
  take_frame(odometry, depth, info, now);
  const time::Time taken = stamp;
  tolerance_.note(taken);
  depth_.drop_until(taken - tolerance);
  info_.drop_until(taken - tolerance);
  pose_.drop_until(taken);
  return true;
}

void ControllerComponent::take_frame(const Odometry& odometry, const Image* depth, const Info* info, time::Time now) {
  context_.status().value("frames", ++frames_);
  if (odometry.header().frame_id() != map_frame_ || odometry.child_frame_id() != base_frame_) {
    return drop("pose", "it is not of " + base_frame_ + " in " + map_frame_);
  }
  const auto T_map_base = to_core(odometry.pose().pose());
  if (!T_map_base) return drop("pose", T_map_base.reason);
  const time::Time stamp = messages::from_message(odometry.header().stamp());
  if (!is_of_camera(stamp)) return drop("pose", "its stamp is far from those of the camera");
  controller_.set_pose(*T_map_base, stamp - clock_steps_, now);
  if (depth == nullptr || info == nullptr)
    return drop("pose without view", "no depth image or camera info of its stamp");
  see(*depth, *info, now);
}

void ControllerComponent::see(const Image& depth, const Info& info, time::Time now) {
  const auto T_base_camera = static_transforms_.find(base_frame_, depth.header().frame_id());
  if (!T_base_camera) return drop("depth", "no transform from " + base_frame_ + " to its frame on /tf_static");
  const auto view = to_core(depth, info, *T_base_camera, rectifier_);
  if (!view) return drop("depth", view.reason);
  controller_.see(*view, messages::from_message(depth.header().stamp()) - clock_steps_, now);
}

/// Obstacles whose stamp is far from those of the camera wait for it, or for newer ones.
void ControllerComponent::take_map(time::Time now) {
  const auto convert = [this](std::optional<OccupancyGrid>& message) -> std::optional<Grid> {
    if (!message) return std::nullopt;
    auto grid = message->header().frame_id() == map_frame_
                    ? to_core(*message)
                    : messages::Converted<Grid>::refused("it is not in " + map_frame_);
    if (!grid) drop("grid", grid.reason);
    return std::move(grid.value);
  };
  if (auto plan = convert(plan_)) controller_.set_plan(std::move(*plan));
  plan_.reset();
  if (!obstacles_) return;
  const time::Time stamp = messages::from_message(obstacles_->header().stamp());
  if (!is_of_camera(stamp)) return;
  if (auto obstacles = convert(obstacles_)) {
    controller_.set_obstacles(std::move(*obstacles), stamp - clock_steps_, now);
  }
  obstacles_.reset();
}

/// An unusable path stops the robot, like an empty one, because the previous path is no longer wanted.
void ControllerComponent::take_path(const Path& message) {
  auto path = to_core(message);
  if (!path) return refuse_path(path.reason);
  const std::string& frame = message.header().frame_id();
  if (frame == map_frame_) return controller_.set_path(std::move(*path), "the planner's path is empty");
  if (frame != base_frame_) return refuse_path("its frame is neither " + map_frame_ + " nor " + base_frame_);
  const auto turn_rad = turn_on_the_spot(*path);
  if (!turn_rad) return refuse_path("in " + base_frame_ + " it may only turn on the spot");
  controller_.set_turn(*turn_rad);
}

void ControllerComponent::refuse_path(const std::string& problem) {
  drop("path", problem);
  controller_.set_path({}, "path refused: " + problem);
}

void ControllerComponent::note_frame(const lapis_msgs::msg::TrackedFrame& frame) {
  controller_.set_weak_views(frame.source() != lapis_msgs::msg::TrackedFrame_Constants::SOURCE_VISION);
}

void ControllerComponent::add_mount(const tf2_msgs::msg::TFMessage& message) {
  const std::string problem = static_transforms_.add(message);
  if (!problem.empty()) drop("static transform", problem);
}

void ControllerComponent::drop(const std::string& what, const std::string& reason) {
  context_.status().count(what + " dropped: " + reason);
  if (context_.rate_limit().pass(what + reason)) spdlog::warn("{} dropped: {}", what, reason);
}

/// All decisions pass through here, so that only finite commands are published.
void ControllerComponent::publish(Decision decision, time::Time now) {
  if (!is_finite(decision.command)) {
    drop("command", "it is not finite");
    decision = {State::kStopped, "the command was not finite", {}, 0.0, {}};
  }
  command_.publish(to_message(decision.command));
  if (odometry_ != nullptr) publish_odometry(decision.command, now);
  local_path_.publish(to_message(decision.local_path, messages::header(camera_stamp_, map_frame_)));
  publish_status(decision, now);
}

/// Motion goes by the clock of `now`, stamps by that of the camera; both are the same in lock-step. A stamp that does
/// not come after the one before is of a frame that came twice, or of a camera that has fallen behind: the next one has
/// the motion in it. Nothing before the first image, and nothing between a run in lock-step and the next one.
void ControllerComponent::publish_odometry(const Velocity& command, time::Time now) {
  if (camera_stamp_.nanoseconds == 0 || camera_ahead_.has_value() != context_.is_free()) return;
  motion_.add(command, now);
  if (!odometry_since_) odometry_since_ = now;
  if (now >= *odometry_since_ && now - *odometry_since_ < kOdometrySilence) return;
  const time::Time stamp = motion_.stamp() + camera_ahead_.value_or(time::Duration{});
  if (published_until_ && stamp <= *published_until_ && *published_until_ - stamp < time::kRestartGap) return;
  published_until_ = stamp;
  const auto message = to_message(motion_, messages::header(stamp, odom_frame_), base_frame_);
  const auto T_odom_base = messages::from_message(message.pose().pose());
  if (!T_odom_base) return drop("odometry", T_odom_base.reason);
  odometry_->publish(message);
  tf2_msgs::msg::TFMessage transforms;
  transforms.transforms().push_back(messages::stamped_transform(message.header(), base_frame_, *T_odom_base));
  transforms_->publish(transforms);
}

void ControllerComponent::publish_status(const Decision& decision, time::Time now) {
  using Level = runtime::Status::Level;
  const bool is_well = decision.state == State::kIdle || decision.state == State::kFollowing;
  context_.status().set(is_well ? Level::kOk : Level::kWarn, decision.reason);
  const bool has_changed = !reported_at_ || decision.state != reported_.state || decision.reason != reported_.reason;
  if (!has_changed && abs(now - *reported_at_) < kStatusPeriod) return;
  if (has_changed && !is_well) spdlog::warn("stands still: {}", decision.reason);
  reported_at_ = now;
  reported_ = decision;
  status_.publish(to_message(decision, messages::header(camera_stamp_, map_frame_)));
}

void ControllerComponent::finish() {
  command_.publish(to_message(Velocity{}));
  command_.wait_until_acknowledged(kFarewell_s);
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
}

}  // namespace lapis::controller

template int lapis::runtime::run_component<lapis::controller::ControllerComponent>(int argc, char** argv);
