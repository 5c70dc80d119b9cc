#include "slam/core/rgbd_slam.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "slam/core/calibration/focal_correction.hpp"
#include "slam/core/calibration/kept_depth.hpp"
#include "slam/core/frame/noise_model.hpp"
#include "slam/core/front_end/front_end.hpp"
#include "slam/core/graph/due_result.hpp"
#include "slam/core/graph/graph_correction.hpp"
#include "slam/core/graph/graph_marginals.hpp"
#include "slam/core/graph/slam_graph.hpp"
#include "slam/core/loops/loop_detector.hpp"
#include "slam/core/loops/map_joiner.hpp"
#include "slam/core/mapping/map_builder.hpp"
#include "slam/core/motion/late_depth.hpp"
#include "slam/core/motion/motion_model.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

constexpr const char* kGivenUp = "a part of the map was given up, because the camera was soon lost again";

// Number of new key-frames after which the marginals of the graph are computed again.
constexpr std::size_t kAnalysedTogether = 10;

template <class Pixel>
bool has_size(const geometry::Image<Pixel>& image, const geometry::PinholeCamera& camera) {
  return image.width == camera.width && image.height == camera.height &&
         image.pixels.size() == static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

// Why a frame cannot be used; nothing when it can.
std::optional<std::string> find_fault(const RgbdFrame& frame, const NoiseConfig& noise) {
  if (!geometry::is_valid(frame.camera)) return "invalid camera";
  if (!has_size(frame.gray, frame.camera)) return "colour image size differs from the camera's";
  if (!has_size(frame.depth, frame.camera)) return "depth image size differs from the camera's";
  const auto& pixels = frame.depth.pixels;
  const bool has_depth = std::any_of(pixels.begin(), pixels.end(), [&](float z) { return is_depth(noise, z); });
  if (!has_depth) return "no depth";
  return std::nullopt;
}

std::string reason_without_place(const MapJoiner::Evidence& evidence) {
  if (evidence.keyframes == 0) return "in a sub-map, of which no place of the map is recognised yet";
  char text[160];
  std::snprintf(text, sizeof text,
                "in a sub-map: %zu key-frames over %.1f m, with views over %.1f m, agree on its place, %zu do not",
                evidence.keyframes, evidence.span_m, evidence.shown_m, evidence.others);
  return text;
}

}  // namespace

class RgbdSlam::Implementation {
 public:
  Implementation(const SlamConfig& config, const Pose& T_map_first_camera, const Pose& T_base_camera)
      : config_(config), T_map_first_camera_(T_map_first_camera), extractor_(config.features), front_end_(config),
        motion_(config, T_base_camera), builder_(config), loops_(config), joiner_(config) {}

  Implementation(const SlamConfig& config, const Pose& T_base_camera, SlamState state)
      : Implementation(config, T_base_camera, T_base_camera) {
    map_ = restore_map(state);
    is_resumed_ = true;
    graph_ = SlamGraph(std::move(state.edges), std::move(state.links), std::move(state.covariances));
    loops_.restore(map_);
    version_ = state.graph_version;
    if (state.wheels.motions > 0.0) motion_.resume_wheels(state.wheels);
    if (const auto& last = state.motion) {
      motion_.resume(last->stamp, last->camera, last->odometry);
      has_odometry_ = !last->odometry.empty();
      front_end_.resume(map_, state.reference, last->held_stamp, has_odometry_);
    } else {
      builder_ = MapBuilder(config, map_.keyframes().size());
      front_end_.resume(map_, state.reference, std::nullopt, false);
    }
    must_optimize_ = graph_.count(EdgeType::kLoopClosure) > 0;  // an optimisation may have been under way
    optimize();
  }

  SlamState state() const {
    SlamState state{config_.features.scale_factor,
                    version_,
                    front_end_.reference(),
                    map_.keyframes(),
                    {},
                    graph_.edges(),
                    graph_.links(),
                    graph_.covariances(),
                    motion_.wheels(),
                    saved_motion(),
                    {}};
    for (const Keyframe& keyframe : map_.keyframes()) state.parts.push_back(keyframe.sub_map);
    state.landmarks.reserve(map_.landmarks().size());
    for (const Landmark& landmark : map_.landmarks()) {
      state.landmarks.push_back({landmark.p_map, landmark.finest_distance_m});
    }
    return state;
  }

  bool add_odometry(time::Time stamp, const Pose& T_odom_base) {
    has_odometry_ = true;
    return motion_.add_odometry(stamp, T_odom_base);
  }

  // The front end locates the frame; mapping extends the map with it; loop detection finds out whether the camera was
  // here before; the graph then moves all of the map, a fixed number of frames later.
  TrackingResult process(const RgbdFrame& input) {
    ++frame_count_;
    take_results(frame_count_);
    if (const auto fault = find_fault(input, config_.noise)) return without_vision(input.stamp, *fault);
    if (input.depth_delay != time::Duration{}) return process_late(input);
    return process(make_frame(input, extractor_, config_.noise));
  }

  TrackingResult process(const Frame& frame) {
    const RgbdFrame& input = *frame.input;
    FrameOutcome outcome = map_.empty() ? front_end_.begin(known(), frame) : front_end_.locate(known(), frame);
    TrackingResult& result = outcome.result;
    if (outcome.begins_part && !map_.empty() && !leave_part()) return without_vision(input.stamp, kGivenUp);
    if (outcome.wants_keyframe) {
      const KeyframeId id = outcome.begins_part ? builder_.begin(model(), frame, T_map_first_camera_)
                                                : builder_.extend(model(), frame, outcome);
      close_loops(frame, id);
      join_parts(frame, id);
      front_end_.enter_keyframe(map_, id);
      ++version_;
      become_keyframe(id, result);
      analyse();
    }
    if (outcome.ends_drift) request_optimization();
    if (outcome.seen || result.is_keyframe) {
      motion_.update(map_, input.stamp, {result.keyframe_id, result.T_keyframe_camera, result.covariance});
    }
    if (kept_depth_) {
      const auto T_map_camera =
          has_pose(result) ? std::optional<Pose>(result.T_map_keyframe * result.T_keyframe_camera) : std::nullopt;
      kept_depth_->add(map_, input, T_map_camera,
                       result.is_keyframe ? std::optional(result.keyframe_id) : std::nullopt);
    }
    if (has_pose(result) && map_.keyframe(result.keyframe_id).sub_map != kWholeMap) {
      result.state = TrackingState::kUnconnected;
      result.source = PoseSource::kNone;
      result.reason = reason_without_place(joiner_.evidence());
    }
    result.graph_version = version_;
    return result;
  }

  TrackingResult without_vision(time::Time stamp, const std::string& reason) const {
    TrackingResult result = front_end_.without_vision(known(), stamp, reason);
    result.graph_version = version_;
    return result;
  }

  void settle() {
    do {
      take_results(std::numeric_limits<std::uint64_t>::max());
    } while (optimization_.is_busy());
  }

  bool change_focal_length(double ratio) {
    settle();
    if (!can_be_remade(map_, graph_)) return false;
    remake_map(config_, ratio, map_);
    follow_new_map();
    return true;
  }

  void keep_depth(bool keeps) {
    kept_depth_.reset();
    if (keeps) kept_depth_.emplace();
  }

  bool correct_depth(const DepthOffset& offset) {
    settle();
    const auto kept = std::exchange(kept_depth_, std::nullopt);
    if (!kept || kept->keyframes() != map_.keyframes().size() || !can_be_remade(map_, graph_)) return false;
    kept->correct(config_, offset, map_);
    adjust_whole_map(config_, map_);
    follow_new_map();
    return true;
  }

  std::optional<Pose> odometry_at(time::Time stamp) const { return motion_.odometry_at(stamp); }
  PoseGraphSnapshot pose_graph() const { return without_sub_maps(graph_.snapshot(map_, version_), map_); }
  SubMapSummary sub_maps() const { return sub_maps_; }
  bool is_given_up() const { return is_given_up_; }
  LoopSummary loops() const {
    return {graph_.count(EdgeType::kLoopClosure), last_loop_, loops_.revisits(), graph_.loops_removed()};
  }
  std::uint64_t version() const { return version_; }
  const Map& map() const { return map_; }
  std::size_t slip_count() const { return builder_.slip_count(); }
  std::optional<WheelCalibration> wheels() const {
    return has_odometry_ ? std::optional(motion_.wheels()) : std::nullopt;
  }
  std::size_t places_doubted() const { return front_end_.places_doubted(); }

 private:
  // Depth of another instant is brought to the view of colour by the motion between: that which is predicted, and then
  // that which the frame shows with it.
  TrackingResult process_late(const RgbdFrame& input) {
    late_depth_.add(input);
    const MeasuredDepth& depth = late_depth_.nearest();
    const auto expected = expected_motion(input.stamp, depth.stamp);
    if (!expected) return process(make_frame(input, extractor_, config_.noise));
    RgbdFrame moved = input;
    moved.depth = seen_from(*expected, depth);
    Frame frame = make_frame(moved, extractor_, config_.noise);
    const auto T_map_camera = front_end_.guess(known(), frame);
    const auto shown =
        T_map_camera ? motion_.motion_through(map_, input.stamp, *T_map_camera, depth.stamp) : std::nullopt;
    if (shown) {
      moved.depth = seen_from(*shown, depth);
      renew_depths(config_.noise, frame);
    }
    return process(frame);
  }

  std::optional<Pose> expected_motion(time::Time from, time::Time to) const {
    const auto T_map_from = motion_.predict(map_, from), T_map_to = motion_.predict(map_, to);
    if (!T_map_from || !T_map_to) return std::nullopt;
    return T_map_from->inverse() * *T_map_to;
  }

  std::optional<SavedMotion> saved_motion() const {
    const auto stamp = motion_.last_stamp(), held_stamp = front_end_.held_stamp();
    const auto camera = motion_.last_camera();
    if (!stamp || !camera || !held_stamp) return std::nullopt;
    return SavedMotion{*stamp, *camera, *held_stamp, motion_.odometry_readings()};
  }

  Known known() const { return {map_, graph_, loops_, motion_}; }
  Model model() { return {map_, graph_, motion_}; }

  void close_loops(const Frame& frame, KeyframeId id) {
    const std::vector<PoseGraphEdge> found = loops_.add(map_, graph_, front_end_.tracker(), frame, id);
    for (const PoseGraphEdge& loop : found) graph_.add_edge(loop);
    if (found.empty()) return;
    last_loop_ = frame.input->stamp;
    request_optimization();
  }

  // Leaves the part in which the camera was lost for a new sub-map. False when that part is too small to be ever joined
  // and is given up: the camera is lost in the map as before it, or another map has to begin.
  bool leave_part() {
    motion_.forget();
    const KeyframeId part = front_end_.sub_map(map_);
    const bool is_kept = part == kWholeMap && (is_resumed_ || sub_maps_.begun > 0);
    if (is_kept || joiner_.is_large_enough(map_, part)) {
      ++sub_maps_.begun;
      return true;
    }
    if (part == kWholeMap) {
      is_given_up_ = true;
      return false;
    }
    ++sub_maps_.given_up;
    map_.clear(part);
    front_end_.give_up(map_);
    return false;
  }

  // A junction waits for the optimisation under way, which does not know it.
  void join_parts(const Frame& frame, KeyframeId id) {
    joiner_.look(map_, loops_, front_end_.tracker(), frame, id);
    const auto junction = optimization_.is_busy() ? std::nullopt : joiner_.junction();
    if (!junction) return;
    graph_.join(*junction, map_);
    ++sub_maps_.joined;
    last_loop_ = frame.input->stamp;
    request_optimization();
  }

  void follow_new_map() {
    graph_.remeasure(map_);
    loops_.drop_pending();
    front_end_.renew(map_);
    ++version_;
  }

  void request_optimization() {
    must_optimize_ = true;
    optimize();
  }

  std::uint64_t due() const { return frame_count_ + static_cast<std::uint64_t>(config_.loop.latency_frames); }

  void optimize() {
    if (!must_optimize_ || optimization_.is_busy()) return;
    must_optimize_ = false;
    optimization_.start(due(), [graph = graph_.snapshot(map_, version_)] { return correct_graph(graph); });
  }

  // Between optimisations, too, the covariances of the newest key-frames follow from all edges.
  void analyse() {
    if (optimization_.is_busy() || analysis_.is_busy()) return;
    if (map_.keyframes().size() < graph_.analysed() + kAnalysedTogether) return;
    analysis_.start(due(), [graph = graph_.snapshot(map_, version_), weights = graph_.weights()] {
      return graph_marginals(graph, weights);
    });
  }

  // An analysis under way was started before the optimisation under way, and is due no later.
  void take_results(std::uint64_t frame) {
    if (const auto marginals = analysis_.take(frame)) graph_.learn(map_, *marginals);
    if (const auto correction = optimization_.take(frame)) correct(*correction);
  }

  void correct(const GraphCorrection& correction) {
    graph_.apply(correction, map_);
    front_end_.renew(map_);
    ++version_;
    optimize();
  }

  // The frame becomes its own reference.
  void become_keyframe(KeyframeId id, TrackingResult& result) const {
    result.is_keyframe = true;
    result.keyframe_id = id;
    result.T_map_keyframe = map_.keyframe(id).T_map_camera;
    result.T_keyframe_camera = Pose::Identity();
    result.covariance = Matrix6d::Zero();
  }

  SlamConfig config_;
  Pose T_map_first_camera_;
  FeatureExtractor extractor_;
  FrontEnd front_end_;
  MotionModel motion_;
  LateDepth late_depth_;
  std::optional<KeptDepth> kept_depth_;
  Map map_;
  SlamGraph graph_;
  MapBuilder builder_;
  LoopDetector loops_;
  MapJoiner joiner_;
  SubMapSummary sub_maps_;
  bool is_resumed_ = false;
  bool is_given_up_ = false;
  DueResult<GraphCorrection> optimization_;
  DueResult<GraphMarginals> analysis_;
  std::optional<time::Time> last_loop_;
  bool must_optimize_ = false;  // there are edges that no optimisation has included
  std::uint64_t frame_count_ = 0;
  std::uint64_t version_ = 0;
  bool has_odometry_ = false;
};

RgbdSlam::RgbdSlam(const SlamConfig& config, const Pose& T_map_first_camera, const Pose& T_base_camera)
    : implementation_(std::make_unique<Implementation>(config, T_map_first_camera, T_base_camera)) {}
RgbdSlam::RgbdSlam(const SlamConfig& config, const Pose& T_base_camera, SlamState state)
    : implementation_(std::make_unique<Implementation>(config, T_base_camera, std::move(state))) {}
RgbdSlam::~RgbdSlam() = default;

TrackingResult RgbdSlam::process(const RgbdFrame& frame) { return implementation_->process(frame); }
bool RgbdSlam::add_odometry(time::Time stamp, const Pose& T_odom_base) {
  return implementation_->add_odometry(stamp, T_odom_base);
}
std::optional<Pose> RgbdSlam::odometry_at(time::Time stamp) const { return implementation_->odometry_at(stamp); }
TrackingResult RgbdSlam::skip(time::Time stamp, const std::string& reason) const {
  return implementation_->without_vision(stamp, reason);
}
void RgbdSlam::settle() { implementation_->settle(); }
LoopSummary RgbdSlam::loops() const { return implementation_->loops(); }
SubMapSummary RgbdSlam::sub_maps() const { return implementation_->sub_maps(); }
bool RgbdSlam::is_given_up() const { return implementation_->is_given_up(); }
void RgbdSlam::keep_depth(bool keeps) { implementation_->keep_depth(keeps); }
bool RgbdSlam::correct_depth(const DepthOffset& offset) { return implementation_->correct_depth(offset); }
bool RgbdSlam::change_focal_length(double ratio) { return implementation_->change_focal_length(ratio); }
PoseGraphSnapshot RgbdSlam::pose_graph() const { return implementation_->pose_graph(); }
SlamState RgbdSlam::state() const { return implementation_->state(); }
std::uint64_t RgbdSlam::graph_version() const { return implementation_->version(); }
std::size_t RgbdSlam::keyframe_count() const { return implementation_->map().keyframes().size(); }
std::size_t RgbdSlam::landmark_count() const { return implementation_->map().landmark_count(); }
const Map& RgbdSlam::map() const { return implementation_->map(); }
std::size_t RgbdSlam::slip_count() const { return implementation_->slip_count(); }
std::optional<WheelCalibration> RgbdSlam::wheels() const { return implementation_->wheels(); }
std::size_t RgbdSlam::places_doubted() const { return implementation_->places_doubted(); }

}  // namespace lapis::slam
