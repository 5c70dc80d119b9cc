#include "slam/slam_component.hpp"

#include <cmath>
#include <filesystem>
#include <opencv2/core/utility.hpp>
#include <sstream>

#include "common/files/atomic_file.hpp"
#include "common/messages/time.hpp"
#include "common/runtime/run_component.hpp"
#include "common/topics/robot.hpp"
#include "common/topics/slam.hpp"
#include "common/topics/transforms.hpp"
#include "common/trajectory/trajectory.hpp"
#include "slam/core/files/pose_graph_file.hpp"

namespace lapis::slam {
namespace {

constexpr std::size_t kEarlyReadings = 1000;
constexpr std::size_t kViewsToContradict = 8;
constexpr int kMostDoubtfulFrames = 15;  // about as many as a recognised place needs to be confirmed, several times
constexpr double kFarewell_s = 1.0;
constexpr double kLongestSave_s = 600.0;
constexpr double kOldestMotion_s = 10.0;  // a saved pose is renewed at this age, see autosave()
constexpr const char* kGraphFile = "pose_graph.g2o";
constexpr const char* kKeyframesFile = "keyframes.txt";
constexpr const char* kMapFile = "slam.lapis";
constexpr time::Duration kStatusPeriod{1'000'000'000};

void set_wheels(const std::optional<WheelCalibration>& wheels, lapis_msgs::msg::SlamStatus& message) {
  if (!wheels) return;
  message.distance_scale(wheels->distance_scale);
  message.distance_scale_sigma(std::sqrt(wheels->distance_variance));
  message.turn_scale(wheels->turn_scale);
  message.turn_scale_sigma(std::sqrt(wheels->turn_variance));
  message.wheel_noise(wheels->noise);
}

/// With `ratio` times the focal length of colour. In the images, depth stays where it is: the depth camera's focal
/// length is longer by the same factor, and the distance between the cameras shorter.
images::RgbdCalibration with_focal_length(images::RgbdCalibration cameras, double ratio) {
  for (auto* camera : {&cameras.color.pinhole, &cameras.depth.pinhole}) {
    camera->fx *= ratio;
    camera->fy *= ratio;
  }
  cameras.T_color_depth.translation().head<2>() /= ratio;
  return cameras;
}

}  // namespace

SlamComponent::SlamComponent(const Config& config, runtime::Context& context)
    : config_(config), context_(context), ids_{context.frame("map"), context.frame("odom"), context.frame("base_link")},
      odometry_(context.advertise(topics::kSlamOdometry)), tracked_frame_(context.advertise(topics::kTrackedFrame)),
      transforms_(context.advertise(topics::kTransforms)), path_(context.advertise(topics::kKeyframePath)),
      pose_graph_(context.advertise(topics::kPoseGraph)), status_(context.advertise(topics::kSlamStatus)),
      landmarks_(context, config.landmark_period_s),
      input_(time::Duration::from_seconds(config.max_stamp_difference_s), static_transforms_, context),
      disk_({SlamComponent::kName,
             config.output_dir,
             config.resume_from,
             {kMapFile, kGraphFile, kKeyframesFile},
             config.autosave_period_s},
            context) {
  const bool estimates_depth = config.depth_calibration == "estimate";
  if (estimates_depth) depth_estimate_ = &context.advertise(topics::kDepthEstimate);
  renew_calibrator();
  cv::setNumThreads(1);  // the other processes need their cores; results do not depend on it
  load_map();
  input_.on_restart([this] {
    if (slam_ == nullptr) return;  // none has begun since the camera restarted last
    spdlog::warn("the camera's stamps went back, so it has started anew: a new map begins");
    end_map();
  });
  input_.on_clock_set([this](time::Duration step) { follow_clock(step); });
  context.subscribe(topics::kStaticTransforms, [this](const auto& m) { add_mount(m); });
  context.subscribe(topics::kWheelOdometry, [this](const auto& m) { add_odometry(m); });
  context.on_cycle([this](const runtime::Cycle& cycle) { work(cycle); });
}

/// Loads the map to resume, if there is one; throws with the file and the remedy.
void SlamComponent::load_map() {
  resumed_ = disk_.resume(read_slam_file);
  if (!resumed_) return;
  const double scale = resumed_->state.scale_factor;
  if (scale != config_.method.features.scale_factor) {
    throw std::runtime_error(
        disk_.misfit("slam.features.scale_factor was " + std::to_string(scale) + " when it was made: set it so again"));
  }
  session_ = resumed_->session;
  epoch_ = resumed_->epoch;
  spdlog::info("{}: {} key-frames, {} landmarks", config_.resume_from, resumed_->state.keyframes.size(),
               resumed_->state.landmarks.size());
}

void SlamComponent::work(const runtime::Cycle& cycle) {
  while (next_frame(cycle)) {
  }
  if (slam_ == nullptr) return report_waiting();
  publish_graph(cycle.is_final);
  publish_landmarks(cycle.is_final);
  autosave();
}

/// Processes the oldest frame; false when what it needs may still come.
bool SlamComponent::next_frame(const runtime::Cycle& cycle) {
  const auto frame = input_.oldest(cycle);
  if (!frame) return false;
  if (!frame->problem.empty()) {
    drop(frame->stamp, frame->problem);
  } else if (prepare(*frame)) {
    track(*frame);
  } else if (!cycle.inputs_complete) {
    return false;  // the mount may still come
  } else {
    drop(frame->stamp, "the camera's mount is not known");
  }
  input_.pop(*frame);
  return true;
}

/// Begins a map if there is none yet; false while the camera's mount is not known.
bool SlamComponent::prepare(const JoinedFrame& first) {
  if (slam_ != nullptr) return true;
  frame_.optical_frame = first.optical_frame;
  const auto T_base_camera = static_transforms_.find(ids_.base, frame_.optical_frame);
  if (!T_base_camera) {
    const std::string problem = "no transform from " + ids_.base + " to " + frame_.optical_frame + " on /tf_static";
    context_.status().set(runtime::Status::Level::kWarn, "waiting: " + problem);
    if (context_.rate_limit().pass("mount")) spdlog::warn("waiting: {}", problem);
    waits_for_ = problem;
    return false;
  }
  frame_.T_base_camera = *T_base_camera;
  disk_.begin(first.stamp, resumed_.has_value());
  name_map(first.stamp);
  slam_ = begin_map();
  slam_->keep_depth(depth_estimate_ != nullptr && !delay_.is_over());
  renew_watch();
  for (const auto& [stamp, T_odom_base] : early_odometry_) slam_->add_odometry(stamp, T_odom_base);
  early_odometry_.clear();
  graph_version_ = 0;
  landmarks_.begin_epoch(session_, epoch_, keyframe_ids_);
  return true;
}

/// Names the map that begins: its session, the epoch of its landmarks, and the ids of its key-frames. A map that
/// continues in its session skips what can have been published since it was saved.
void SlamComponent::name_map(time::Time first_stamp) {
  const bool continues = resumed_ && config_.resume_session;
  if (!continues) session_ = std::max({first_stamp.nanoseconds, session_ + 1, epoch_ + 1});
  epoch_ = continues ? std::max(first_stamp.nanoseconds, epoch_ + 1) : session_;
  frame_.session = session_;
  keyframe_ids_ = resumed_ ? resumed_->keyframe_ids : PublishedIds{};
  if (!resumed_) return;
  auto& motion = resumed_->state.motion;
  if (motion && (!continues || first_stamp <= motion->stamp)) motion.reset();  // of another run, or another clock
  if (!continues) return;
  keyframe_ids_.skip(resumed_->state.keyframes.size());
  resumed_->state.graph_version += PublishedIds::kSkipped;
  spdlog::info("session {} continues", session_);
}

std::unique_ptr<RgbdSlam> SlamComponent::begin_map() {
  if (!resumed_) return std::make_unique<RgbdSlam>(config_.method, frame_.T_base_camera, frame_.T_base_camera);
  saved_camera_ = resumed_->state.keyframes.back().camera;
  saved_version_ = resumed_->state.graph_version;
  if (const auto& depth = resumed_->depth_camera; depth && depth_estimate_ == nullptr) {
    spdlog::warn("{}: its cameras were estimated, which slam.depth_calibration: given leaves out", config_.resume_from);
  } else if (depth) {
    cameras_ = images::RgbdCalibration{{*saved_camera_, {}}, depth->camera, depth->T_color_depth};
  }
  keep_estimate();
  auto slam = std::make_unique<RgbdSlam>(config_.method, frame_.T_base_camera, std::move(resumed_->state));
  resumed_.reset();
  return slam;
}

/// Refuses the resumed map of another camera. Else its new names are saved before anything is published under them: if
/// this process dies, too, the next one must not use them again.
void SlamComponent::accept_saved_map(const geometry::PinholeCamera& camera,
                                     const sensor_msgs::msg::CameraInfo& stated) {
  constexpr double kMostWrong = 1.2;  // focal length that a map was corrected to; by more, it is another camera's
  const double ratio = stated.k()[0] / camera.fx;
  if (!is_same_camera(*saved_camera_, camera) || ratio > kMostWrong || ratio < 1.0 / kMostWrong) {
    throw runtime::BadSetup(disk_.misfit("was made with another camera, of " + std::to_string(saved_camera_->width) +
                                         " x " + std::to_string(saved_camera_->height) + " px"));
  }
  saved_camera_.reset();
  if (!disk_.is_kept()) return;
  const runtime::LongWork work(context_.heart(), "saves the resumed map", kLongestSave_s);
  note_save(write_slam_file(disk_.path(kMapFile), saved_map()));
}

void SlamComponent::track(const JoinedFrame& joined) {
  auto frame = input_.convert(joined);
  if (!frame) return drop(joined.stamp, frame.reason);
  if (saved_camera_) accept_saved_map(frame->camera, *joined.info);
  frame->stamp = clock_.advance(joined.stamp, time::Arrival::clock::now());
  if (calibrate_depth(*frame, *joined.info)) {
    const time::Time stamp = frame->stamp;
    frame = input_.convert(joined);
    if (!frame) return drop(joined.stamp, frame.reason);
    frame->stamp = stamp;
  }
  frame->depth_delay = depth_delay_;
  ++frames_total_;
  frame_.stamp = joined.stamp;
  const TrackingResult result = slam_->process(*frame);
  if (result.state == TrackingState::kTracking) ++frames_tracked_;
  publish(result);
  if (slam_->is_given_up()) return give_map_up();
  judge_clock(result);
  const auto later = messages::to_message(messages::from_message(joined.info->header().stamp()) + time::Duration{1});
  watch_delay(*frame, result, later);
  if (!result.is_keyframe) return;
  watch_scale();
  watch_focal_length(*joined.info, later);
}

/// Reports once that depth and odometry disagree about distances.
void SlamComponent::watch_scale() {
  const auto wheels = slam_->wheels();
  if (is_scale_doubted_ || !wheels || !doubts_scale(*wheels)) return;
  is_scale_doubted_ = true;
  const double off = wheels->distance_scale - 1.0;
  const std::string text =
      fmt::format("depth seems to be {:.1f} % (+- {:.1f}) too {} by odometry", 100.0 * std::abs(off),
                  100.0 * std::sqrt(wheels->distance_variance), off > 0.0 ? "far" : "near");
  context_.status().value("depth_scale", text);
  spdlog::warn("{}: or the wheels are {} than configured; measure a known distance", text,
               off > 0.0 ? "larger" : "smaller");
}

/// Reports once that depth is of another instant than colour.
void SlamComponent::watch_delay(const RgbdFrame& frame, const TrackingResult& result,
                                const builtin_interfaces::msg::Time& after) {
  if (delay_.is_over()) return;
  const auto found = delay_.add(
      frame, has_pose(result) ? std::optional<geometry::Pose>(result.T_map_keyframe * result.T_keyframe_camera)
                              : std::nullopt);
  if (!found && delay_.is_over()) {
    slam_->keep_depth(false);
    name_depth_camera();
  }
  if (!found) return;
  const std::string text = fmt::format("depth seems to be {:.0f} ms {} than colour of the same stamp",
                                       1e3 * std::abs(found->delay_s), found->delay_s > 0.0 ? "later" : "earlier");
  context_.status().value("depth_delay", text);
  if (depth_estimate_ == nullptr) {
    spdlog::warn("{}: correct the stamps, or set slam.depth_calibration: estimate", text);
    calibrator_.reset();  // it takes the delay for a shift
    focal_length_.reset();
    return;
  }
  spdlog::info("{}: corrected by the motion between from now on", text);
  depth_delay_ = time::Duration::from_seconds(found->delay_s);
  doubtful_.clear();
  const images::RgbdCalibration& used = *input_.depth_converter().used();
  const images::RgbdCalibration stated = stated_.value_or(used);
  const DepthOffset elsewhere{found->focal_ratio, found->shift_m};
  const auto cameras = elsewhere == offset_to(used, stated) ? stated : corrected(used, elsewhere);
  if (!(cameras == used)) use_estimate(cameras, after);
  slam_->correct_depth(*found);
  calibrator_.reset();  // where motion is predicted badly, depth of a single view lies beside colour
}

/// Reports that the key-frames contradict the focal length in the camera info: once, or each time that it is corrected.
void SlamComponent::watch_focal_length(const sensor_msgs::msg::CameraInfo& info,
                                       const builtin_interfaces::msg::Time& after) {
  if (!focal_length_) return;
  const Keyframe& newest = slam_->map().keyframes().back();
  focal_length_->add(slam_->map(), newest.id);
  // Depth that is not registered looks like another focal length of colour.
  if (depth_estimate_ == nullptr && calibrator_ && calibrator_->views() < kViewsToContradict) return;
  const auto found = is_focal_length_estimated_ ? focal_length_->refinement() : focal_length_->contradiction();
  if (!found) return;
  const double found_px = newest.camera.fx * found->ratio, stated_px = info.k()[0];
  const std::string text = fmt::format("focal length seems to be {:.1f} px (+- {:.1f}), {} says {:.1f}", found_px,
                                       found_px * found->sigma, topics::kColorInfo.name, stated_px);
  context_.status().value("focal_length", text);
  if (depth_estimate_ != nullptr) return change_focal_length(found->ratio, text, after);
  spdlog::warn("{}: correct fx and fy there, by the same factor {:.3f}", text, found_px / stated_px);
  focal_length_.reset();
}

/// Corrects the map, and the camera of the frames from `since` on.
void SlamComponent::change_focal_length(double ratio, const std::string& why,
                                        const builtin_interfaces::msg::Time& since) {
  const bool is_map_corrected = slam_->change_focal_length(ratio);
  if (!is_map_corrected && is_focal_length_estimated_) {  // a rest of the error, which costs less than the map
    focal_length_.reset();
    return;
  }
  spdlog::info("{}: used from now on", why);
  use_estimate(with_focal_length(*input_.depth_converter().used(), ratio), since);
  if (stated_) stated_ = with_focal_length(*stated_, ratio);
  if (!delay_.is_over()) renew_delay_watch();
  is_focal_length_estimated_ = true;
  renew_watch();
  if (is_map_corrected) return;
  spdlog::warn("the map cannot be corrected any more: a new map begins");
  end_map();
}

void SlamComponent::renew_watch() { focal_length_.emplace(config_.method.noise, config_.method.features.scale_factor); }

void SlamComponent::renew_calibrator() { calibrator_.emplace(depth_estimate_ != nullptr ? 1 : kViewsToContradict); }

/// Compares depth with colour; true when the frame has to be converted again, because the calibration has changed.
bool SlamComponent::calibrate_depth(const RgbdFrame& frame, const sensor_msgs::msg::CameraInfo& info) {
  if (cameras_ && !input_.depth_converter().has_estimate()) {
    spdlog::warn("what is said of the cameras has changed: they are estimated anew");
    cameras_.reset();
    is_focal_length_estimated_ = false;
    stated_.reset();
    doubtful_.clear();
    depth_delay_ = {};
    renew_delay_watch();
    renew_calibrator();
  }
  if (!calibrator_ || !calibrator_->wants(frame.stamp)) return false;
  const bool may_be_late = !delay_.is_over() && delay_.is_moving().value_or(true);
  const bool may_correct_in_vain = !doubtful_.empty() && delay_.is_waiting();
  if (may_be_late && (delay_.is_moving() || may_correct_in_vain)) return false;  // a delay would look like a shift
  const images::RgbdCalibration used = *input_.depth_converter().used();
  const auto alignment = calibrator_->add(frame, used);
  if (calibrator_->views() > 1 && !may_be_late) name_depth_camera();
  if (calibrator_->is_over()) calibrator_.reset();  // its views take tens of megabytes
  if (!alignment) {
    // Those who map with the estimate wait for it, also where there is nothing to correct.
    if (depth_estimate_ != nullptr && !cameras_) use_estimate(used, info.header().stamp());
    return false;
  }
  const images::RgbdCalibration cameras = corrected(used, alignment->offset);
  const std::string found = "depth seems to be of a camera with " + describe(cameras) + " (edges lie " +
                            fmt::format("{:.1f}", alignment->moved_px) + " px off)";
  if (depth_estimate_ == nullptr) {
    context_.status().value("depth_camera", found);
    spdlog::warn("{}: correct /camera/depth/camera_info and /tf_static, or set slam.depth_calibration: estimate",
                 found);
    calibrator_.reset();
    focal_length_.reset();
    return false;
  }
  if (!stated_) stated_ = used;
  doubtful_ = found;
  if (!may_be_late) name_depth_camera();
  use_estimate(cameras, info.header().stamp());
  if (!delay_.is_over()) renew_delay_watch();  // its views are of the registration before
  slam_->keep_depth(!delay_.is_over());
  return true;
}

/// Reports the newest estimate of the depth camera: motion does not explain what it was found by.
void SlamComponent::name_depth_camera() {
  if (doubtful_.empty()) return;
  context_.status().value("depth_camera", doubtful_);
  spdlog::info("{}: used from now on", doubtful_);
  doubtful_.clear();
}

void SlamComponent::renew_delay_watch() {
  delay_ = DelayWatch(stated_ && cameras_ ? offset_to(*cameras_, *stated_) : DepthOffset{});
}

void SlamComponent::use_estimate(const images::RgbdCalibration& cameras, const builtin_interfaces::msg::Time& since) {
  std_msgs::msg::Header header;
  header.stamp(since);
  header.frame_id(frame_.optical_frame);
  const auto info = messages::to_depth_info(header, cameras);
  const std::string problem = input_.depth_converter().set_estimate(info);
  if (!problem.empty()) {
    context_.status().count("estimates of the depth camera dropped: " + problem);
    return;
  }
  cameras_ = cameras;
  depth_estimate_->publish(info);
}

/// The newest estimate counts for all stamps: those to come may be earlier ones, of another run or another clock.
void SlamComponent::keep_estimate() {
  if (cameras_) use_estimate(*cameras_, {});
}

void SlamComponent::add_mount(const tf2_msgs::msg::TFMessage& message) {
  const std::string problem = static_transforms_.add(message);
  if (problem.empty()) return;
  context_.status().count("static transforms dropped: " + problem);
  if (context_.rate_limit().pass("static transforms")) spdlog::warn("static transform dropped: {}", problem);
}

void SlamComponent::add_odometry(const nav_msgs::msg::Odometry& message) {
  const auto T_odom_base = messages::from_message(message.pose().pose());
  std::string problem;
  if (message.child_frame_id() != ids_.base) {
    problem = "its child frame is '" + message.child_frame_id() + "', not '" + ids_.base + "'";
  } else if (message.header().frame_id() != ids_.odom) {
    problem = "its frame is '" + message.header().frame_id() + "', not '" + ids_.odom + "'";
  } else if (!T_odom_base) {
    problem = T_odom_base.reason;
  } else {
    problem = use_odometry(messages::from_message(message.header().stamp()), *T_odom_base);
  }
  if (problem.empty()) {
    has_odometry_ = true;
    return;
  }
  context_.status().count("odometry dropped: " + problem);
  if (context_.rate_limit().pass("odometry")) spdlog::warn("odometry dropped: {}", problem);
}

/// Keeps readings from before the first frame for it. Returns why the reading cannot be used, or an empty text.
std::string SlamComponent::use_odometry(time::Time stamp, const geometry::Pose& T_odom_base) {
  const auto time = context_.is_free() ? clock_.of_odometry(stamp, time::Arrival::clock::now()) : clock_.of(stamp);
  if (!time) return "its stamp is far from those of the camera";
  if (slam_ != nullptr)
    return slam_->add_odometry(*time, T_odom_base) ? "" : "its stamp is not later than the one before";
  early_odometry_.emplace_back(*time, T_odom_base);
  if (early_odometry_.size() > kEarlyReadings) early_odometry_.pop_front();
  return "";
}

/// Counts a frame that cannot be used as not tracked, and publishes this for those who wait for its pose.
void SlamComponent::drop(time::Time stamp, const std::string& reason) {
  ++frames_total_;
  ++frames_dropped_;
  context_.status().count("frames dropped: " + reason);
  if (context_.rate_limit().pass(reason)) spdlog::warn("frame dropped: {}", reason);
  waits_for_ = reason;
  if (slam_ == nullptr) return;  // no session yet to which it could belong
  frame_.stamp = stamp;
  publish(slam_->skip(clock_.advance(stamp, time::Arrival::clock::now()), reason));
}

/// Continues in the time of the map when the stamps of frames have jumped.
void SlamComponent::follow_clock(time::Duration step) {
  if (slam_ == nullptr) return;
  clock_.set(step);
  spdlog::warn("the clock of the camera was set by {:+.1f} s", step.seconds());
  doubtful_frames_ = 0;
  keep_estimate();
  last_pose_.reset();
  graph_stamp_.reset();
  landmarks_.forget_stamps();
  disk_.note_save(frame_.stamp + step);
  saved_stamp_ = saved_stamp_ + step;
}

/// Where stamps jump, the source may have restarted elsewhere. The map is right if vision or odometry continues in it;
/// where neither does so for a while, a new map begins.
void SlamComponent::judge_clock(const TrackingResult& result) {
  if (!doubtful_frames_) return;
  if (has_pose(result)) {
    spdlog::info("the map continues");
    doubtful_frames_.reset();
  } else if (++*doubtful_frames_ >= kMostDoubtfulFrames) {
    spdlog::warn("the place is not in the map, so the camera has started anew: a new map begins");
    end_map();
  }
}

void SlamComponent::give_map_up() {
  spdlog::warn("the camera was lost in a map of {} key-frames, too few to find its place again: a new map begins",
               slam_->keyframe_count());
  end_map();
}

void SlamComponent::end_map() {
  slam_->settle();
  if (const auto problem = write_files()) spdlog::error("{}; tracking continues", *problem);
  slam_.reset();
  keep_estimate();
  clock_ = {};
  doubtful_frames_.reset();
  saved_version_ = 0;
  last_pose_.reset();
  graph_stamp_.reset();
  reported_.reset();
  sub_maps_ = {};
  waits_for_.clear();
}

void SlamComponent::publish(TrackingResult result) {
  result.keyframe_id = keyframe_ids_.of(result.keyframe_id);
  tracked_frame_.publish(to_tracked_frame(result, frame_, ids_));
  if (has_pose(result)) publish_odometry(result);
  publish_status(result);
  report_sub_maps();
}

void SlamComponent::publish_odometry(const TrackingResult& result) {
  auto message = to_odometry(result, frame_, ids_);
  const geometry::Pose T_map_base = result.T_map_keyframe * result.T_keyframe_camera * frame_.T_base_camera.inverse();
  if (last_pose_ && frame_.stamp > last_pose_->first) {
    set_twist(last_pose_->second.inverse() * T_map_base, frame_.stamp - last_pose_->first, message);
  }
  last_pose_.emplace(frame_.stamp, T_map_base);
  odometry_.publish(message);
  publish_transforms(message);
}

/// Unless slam publishes odom -> base_link itself, it publishes map -> odom alone, where it knows odometry.
void SlamComponent::publish_transforms(const nav_msgs::msg::Odometry& odometry) {
  if (config_.publish_odom_frame == "always" || (config_.publish_odom_frame == "auto" && !has_odometry_)) {
    transforms_.publish(to_transforms(odometry, ids_));
  } else if (const auto T_odom_base = slam_->odometry_at(clock_.now())) {
    transforms_.publish(to_correction(odometry, *T_odom_base, ids_));
  }
}

void SlamComponent::publish_graph(bool is_final) {
  if (slam_->graph_version() == graph_version_) return;
  const bool is_due = !graph_stamp_ || (frame_.stamp - *graph_stamp_).seconds() >= config_.graph_period_s;
  if (!is_due && !is_final) return;
  const auto graph = published_graph();
  pose_graph_.publish(to_message(graph, frame_, ids_));
  path_.publish(to_path(graph, frame_, ids_));
  graph_version_ = graph.version;
  graph_stamp_ = frame_.stamp;
}

/// Each version of the landmarks is one of the pose graph, which is published first.
void SlamComponent::publish_landmarks(bool is_final) {
  if (is_final) landmarks_.publish_rest();
  const bool is_graph_out = slam_->graph_version() == graph_version_;
  if (is_graph_out && landmarks_.wants(graph_version_, frame_.stamp, is_final)) {
    landmarks_.begin_version(slam_->map(), graph_version_, messages::header(frame_.stamp, ids_.map));
  }
  landmarks_.publish_part(frame_.stamp);
  if (is_final) landmarks_.publish_rest();
}

void SlamComponent::publish_status(const TrackingResult& result) {
  const bool is_tracking = result.state == TrackingState::kTracking;
  using Level = runtime::Status::Level;
  if (save_problem_.empty()) {
    context_.status().set(is_tracking ? Level::kOk : Level::kWarn, is_tracking ? "tracking" : result.reason);
  } else {
    context_.status().set(Level::kError, "map not saved: " + save_problem_);
  }
  context_.status().value("frames", frames_total_);
  context_.status().value("frames_tracked", frames_tracked_);
  context_.status().value("odometry_slips", slam_->slip_count());
  context_.status().value("places_doubted", slam_->places_doubted());
  const bool has_changed = !reported_ || reported_->second != std::pair(result.state, result.source);
  const bool was_tracking = !reported_ || reported_->second.first == TrackingState::kTracking;
  if (has_changed && !is_tracking && was_tracking) spdlog::warn("tracking lost: {}", result.reason);
  if (is_tracking && !was_tracking) spdlog::info("tracking again");
  if (!has_changed && frame_.stamp - reported_->first < kStatusPeriod) return;
  reported_.emplace(frame_.stamp, std::pair(result.state, result.source));
  lapis_msgs::msg::SlamStatus message;
  message.header().stamp(messages::to_message(frame_.stamp));
  message.header().frame_id(ids_.map);
  message.state(static_cast<std::uint8_t>(result.state));
  message.source(static_cast<std::uint8_t>(result.source));
  message.reason(result.reason);
  message.session(session_);
  message.inliers(result.inliers);
  message.keyframes(static_cast<std::uint32_t>(slam_->keyframe_count()));
  message.landmarks(static_cast<std::uint32_t>(slam_->landmark_count()));
  const LoopSummary loops = slam_->loops();
  message.loop_closures(static_cast<std::uint32_t>(loops.closures));
  if (loops.last) message.last_loop_closure(messages::to_message(*loops.last));
  message.frames_total(frames_total_);
  message.frames_tracked(frames_tracked_);
  message.frames_dropped(frames_dropped_);
  message.loops_removed(static_cast<std::uint32_t>(loops.removed));
  message.places_doubted(static_cast<std::uint32_t>(slam_->places_doubted()));
  set_wheels(slam_->wheels(), message);
  status_.publish(message);
}

void SlamComponent::report_sub_maps() {
  const SubMapSummary now = slam_->sub_maps();
  context_.status().value("sub_maps_begun", now.begun);
  context_.status().value("sub_maps_joined", now.joined);
  context_.status().value("sub_maps_given_up", now.given_up);
  if (now.begun > sub_maps_.begun) spdlog::warn("a sub-map begins: no place of the map is recognised");
  if (now.joined > sub_maps_.joined) spdlog::info("a sub-map was joined to the map");
  if (now.given_up > sub_maps_.given_up) spdlog::warn("a sub-map was given up: the camera was soon lost again");
  sub_maps_ = now;
}

/// Until the first usable frame, nothing else would tell why there is no pose.
void SlamComponent::report_waiting() {
  if (waiting_at_ && context_.now() - *waiting_at_ < kStatusPeriod && context_.now() >= *waiting_at_) return;
  waiting_at_ = context_.now();
  lapis_msgs::msg::SlamStatus message;
  message.header().stamp(messages::to_message(context_.now()));
  message.header().frame_id(ids_.map);
  const std::string silent = context_.silent_topics();
  const std::string missing = silent.empty() ? waits_for_ : silent;
  message.reason(missing.empty() ? "waits for the camera's images" : "waits: " + missing);
  message.frames_total(frames_total_);
  message.frames_dropped(frames_dropped_);
  status_.publish(message);
}

/// Saves the map periodically in a separate thread, so that no frame waits for the disk. A failed save is tried again
/// after the next period, and the old file stays as it was. A map that does not change is saved, too, where there is
/// odometry, because a restarted slam can only lead on from a recent pose.
void SlamComponent::autosave() {
  if (const auto save = saver_.take_finished()) note_save(save->problem);
  if (!disk_.is_due(frame_.stamp) || !saver_.is_free()) return;
  const bool has_changed = slam_->graph_version() != saved_version_;
  const bool is_old = slam_->wheels() && (frame_.stamp - saved_stamp_).seconds() >= kOldestMotion_s;
  if (!has_changed && !is_old) return;
  disk_.note_save(frame_.stamp);
  saved_stamp_ = frame_.stamp;
  saved_version_ = slam_->graph_version();
  saver_.begin(disk_.path(kMapFile), saved_map());
}

void SlamComponent::note_save(const std::optional<std::string>& problem) {
  save_problem_ = problem.value_or("");
  if (!problem) return;
  saved_version_ = 0;
  context_.status().count("map not saved");
  spdlog::error("map not saved: {}; tracking continues", *problem);
}

/// The pose graph with the ids that are published.
PoseGraphSnapshot SlamComponent::published_graph() const {
  PoseGraphSnapshot graph = slam_->pose_graph();
  for (auto& node : graph.nodes) node.id = keyframe_ids_.of(node.id);
  for (auto& edge : graph.edges) {
    edge.from = keyframe_ids_.of(edge.from);
    edge.to = keyframe_ids_.of(edge.to);
  }
  return graph;
}

SlamFile SlamComponent::saved_map() const {
  SlamFile file{session_, epoch_, keyframe_ids_, slam_->state()};
  if (cameras_) file.depth_camera = SavedDepthCamera{cameras_->depth, cameras_->T_color_depth};
  return file;
}

void SlamComponent::finish() {
  spdlog::info("{} of {} frames tracked, {} dropped", frames_tracked_, frames_total_, frames_dropped_);
  for (const auto& [what, number] : context_.status().counters()) spdlog::warn("{}: {}", what, number);
  if (slam_ == nullptr) return;
  const runtime::LongWork work(context_.heart(), "optimises and saves the map", kLongestSave_s);
  slam_->settle();
  publish_graph(true);
  publish_landmarks(true);
  pose_graph_.wait_until_acknowledged(kFarewell_s);
  landmarks_.wait_until_acknowledged(kFarewell_s);
  if (const auto problem = write_files()) throw std::runtime_error(*problem);
}

/// Writes all files of the map; returns the first problem, if any.
std::optional<std::string> SlamComponent::write_files() {
  if (const auto save = saver_.wait()) note_save(save->problem);
  if (!disk_.is_kept() || slam_ == nullptr) return std::nullopt;
  std::optional<std::string> problem;
  if (slam_->keyframe_count() > 0) {
    problem = write_slam_file(disk_.path(kMapFile), saved_map());
  }
  try {
    write_graph();
  } catch (const std::runtime_error& error) {
    if (!problem) problem = error.what();
  }
  return problem;
}

void SlamComponent::write_graph() const {
  const auto graph = published_graph();
  std::ostringstream g2o;
  write_g2o(g2o, graph);
  files::replace_text(disk_.path(kGraphFile), g2o.str());
  trajectory::Trajectory keyframes;
  for (const auto& node : graph.nodes) keyframes.push_back({node.stamp, node.T_map_camera});
  trajectory::write_trajectory(disk_.path(kKeyframesFile), keyframes,
                               "key-frames: camera optical frame in " + ids_.map);
}

}  // namespace lapis::slam

template int lapis::runtime::run_component<lapis::slam::SlamComponent>(int argc, char** argv);
