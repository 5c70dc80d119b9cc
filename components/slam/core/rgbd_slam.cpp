#include "slam/core/rgbd_slam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "slam/core/graph_worker.hpp"
#include "slam/core/keyframe_rule.hpp"
#include "slam/core/local_bundle.hpp"
#include "slam/core/loop_detector.hpp"
#include "slam/core/motion_model.hpp"
#include "slam/core/noise_model.hpp"
#include "slam/core/relocalizer.hpp"
#include "slam/core/slam_graph.hpp"
#include "slam/core/surface_tracker.hpp"
#include "slam/core/tracker.hpp"

namespace lapis::slam {
namespace {

using geometry::Matrix6d;
using geometry::Pose;

template <class Pixel>
bool has_size(const geometry::Image<Pixel>& image, const geometry::PinholeCamera& camera) {
  return image.width == camera.width && image.height == camera.height &&
         image.pixels.size() == static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

// Why a frame cannot be used, if so.
std::optional<std::string> find_fault(const RgbdFrame& frame, const NoiseConfig& noise) {
  if (!geometry::is_valid(frame.camera)) return "invalid camera";
  if (!has_size(frame.gray, frame.camera)) return "colour image size differs from the camera's";
  if (!has_size(frame.depth, frame.camera)) return "depth image size differs from the camera's";
  const auto& pixels = frame.depth.pixels;
  const bool has_depth = std::any_of(pixels.begin(), pixels.end(), [&](float z) { return is_depth(noise, z); });
  if (!has_depth) return "no depth";
  return std::nullopt;
}

}  // namespace

class RgbdSlam::Implementation {
 public:
  Implementation(const SlamConfig& config, const Pose& T_map_first_camera, const Pose& T_base_camera)
      : config_(config), T_map_first_camera_(T_map_first_camera), extractor_(config.features), tracker_(config),
        motion_(config.tracker.max_prediction_s, config.odometry, T_base_camera), loops_(config), relocalizer_(config),
        surfaces_(config) {}

  Implementation(const SlamConfig& config, const Pose& T_base_camera, SlamState state)
      : Implementation(config, Pose::Identity(), T_base_camera) {
    map_ = restore_map(state);
    graph_ = SlamGraph(std::move(state.edges), std::move(state.links), std::move(state.covariances));
    loops_.restore(map_);
    reference_ = state.reference;
    version_ = state.graph_version;
    saved_keyframes_ = map_.keyframes().size();
    if (state.wheels.motions > 0.0) motion_.resume_wheels(state.wheels);
    is_placed_ = false;
    tracker_.set_reference(map_, reference_);
    must_optimize_ = graph_.count(EdgeType::kLoopClosure) > 0;  // it may have been under way
    optimize();
  }

  SlamState state() const {
    SlamState state{config_.features.scale_factor,
                    version_,
                    reference_,
                    map_.keyframes(),
                    {},
                    graph_.edges(),
                    graph_.links(),
                    graph_.covariances(),
                    motion_.wheels()};
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

  TrackingResult process(const RgbdFrame& input) {
    ++frame_count_;
    if (const auto correction = worker_.take(frame_count_)) correct(*correction);
    if (const auto fault = find_fault(input, config_.noise)) return without_vision(input.stamp, *fault);
    const Frame frame = make_frame(input, extractor_, config_.noise);
    if (map_.empty()) return start_map(frame);

    const TrackOutcome seen = find_pose(frame);
    if (!seen.is_tracked) return continue_without_features(frame, seen.reason);
    blind_frames_ = 0;
    is_placed_ = true;
    ++frames_since_keyframe_;
    const bool is_keyframe = needs_keyframe(config_.keyframe, evidence(seen));
    return continue_with(frame, seen, PoseSource::kVision, is_keyframe);
  }

  std::optional<Pose> odometry_at(time::Time stamp) const { return motion_.odometry_at(stamp); }

  void settle() {
    while (const auto correction = worker_.take(std::numeric_limits<std::uint64_t>::max())) correct(*correction);
  }

  PoseGraphSnapshot pose_graph() const { return graph_.snapshot(map_, version_); }
  LoopSummary loops() const {
    return {graph_.count(EdgeType::kLoopClosure), last_loop_, loops_.revisits(), graph_.loops_removed()};
  }
  std::uint64_t version() const { return version_; }
  std::size_t keyframe_count() const { return map_.keyframes().size(); }
  std::size_t landmark_count() const { return map_.landmark_count(); }
  const Map& map() const { return map_; }
  std::size_t slip_count() const { return slips_; }
  std::optional<WheelCalibration> wheels() const {
    return has_odometry_ ? std::optional(motion_.wheels()) : std::nullopt;
  }
  std::size_t places_doubted() const { return relocalizer_.doubted(); }
  TrackingResult without_vision(time::Time stamp, const std::string& reason, const Frame* frame = nullptr) const {
    TrackingResult result;
    result.state = map_.empty() ? TrackingState::kInitializing : TrackingState::kLost;
    result.reason = is_placed_ ? reason : "looking for a place in the saved map: " + reason;
    result.graph_version = version_;
    if (frame != nullptr) result.features = static_cast<std::uint32_t>(frame->features.size());
    const auto reckoned = motion_.dead_reckon(stamp);
    if (!reckoned || !set_drift(stamp, result)) return result;
    if (is_contradicted()) {
      result.reason = "what odometry says contradicts what the camera sees: the robot was carried, or its wheels spin";
    } else if (result.drift_m > config_.odometry.max_drift_m) {
      result.reason = "odometry alone, and its sigma is beyond slam.odometry.max_drift_m: " + reason;
    } else {
      result.state = TrackingState::kDeadReckoning;
      result.source = PoseSource::kOdometry;
      set_pose(*reckoned, result);
    }
    return result;
  }

 private:
  TrackingResult continue_with(const Frame& frame, const TrackOutcome& outcome, PoseSource source, bool is_keyframe) {
    contradictions_ = fits_ = 0;
    held_stamp_ = frame.input->stamp;
    const bool ends_a_drift = ends_drift(outcome);
    follow_reference(outcome);
    TrackingResult result = with_pose(frame, outcome);
    result.source = source;
    if (is_keyframe || ends_a_drift) insert_keyframe(frame, &outcome, result);
    if (ends_a_drift) {
      must_optimize_ = true;
      optimize();
    }
    motion_.update(map_, frame.input->stamp, {result.keyframe_id, result.T_keyframe_camera, result.covariance});
    return result;
  }

  // By surfaces where motion leads, else by odometry. When the camera sees enough features to begin with, but knows
  // none of them, the map continues there.
  TrackingResult continue_without_features(const Frame& frame, const std::string& reason) {
    const bool could_start = frame.features_with_depth >= config_.tracker.min_matches;
    blind_frames_ = could_start ? blind_frames_ + 1 : 0;
    const auto reckoned = motion_.dead_reckon(frame.input->stamp);
    if (!reckoned) return continue_blind(frame, reason, false);
    ++frames_since_keyframe_;
    const MotionModel::Expected expected{map_.keyframe(reckoned->reference).T_map_camera * reckoned->T_reference_camera,
                                         reckoned->covariance};
    const TrackOutcome aligned = surfaces_.track(map_, frame, reference_, expected);
    const bool is_unknown = could_start && !aligned.is_tracked && should_be_known(*reckoned);
    contradictions_ = aligned.is_contradicted || is_unknown ? contradictions_ + 1
                      : is_contradicted()                   ? contradictions_
                                                            : 0;
    fits_ = aligned.is_tracked ? fits_ + 1 : 0;
    const bool fits_by_chance = is_contradicted() && fits_ < config_.tracker.max_contradictions;
    if (!aligned.is_tracked || fits_by_chance) {
      const bool is_new_view = aligned.is_new_view && !could_start && !awaits_confirmation_;
      return continue_blind(frame, reason + "; " + aligned.reason, is_new_view);
    }
    const bool begins_anew = blind_frames_ >= config_.tracker.max_blind_frames;
    if (begins_anew) blind_frames_ = 0;
    return continue_with(frame, aligned, PoseSource::kSurfaces,
                         begins_anew || has_moved(aligned.alignment.T_reference_camera));
  }

  // From so near a key-frame with so many landmarks something is seen again, whatever the camera shows.
  bool should_be_known(const RelativeCamera& camera) const {
    const auto& landmarks = map_.keyframe(camera.reference).landmarks;
    const auto known = std::count_if(landmarks.begin(), landmarks.end(), [](auto id) { return id != kNoLandmark; });
    return known >= 2 * config_.tracker.min_matches && !has_moved(camera.T_reference_camera);
  }

  // The camera does not see what was mapped, for too long. Vision ends that, or surfaces that fit for as long.
  bool is_contradicted() const { return contradictions_ >= config_.tracker.max_contradictions; }

  // The camera is back in a part of the map that is tied to the newest by odometry alone: a key-frame here closes the
  // circle, and the stretch between can be corrected.
  bool ends_drift(const TrackOutcome& outcome) const {
    return graph_.are_apart(outcome.reference, map_.keyframes().back().id);
  }

  // False when odometry does not reach back to the last pose by vision or surfaces: nobody knows.
  bool set_drift(time::Time stamp, TrackingResult& result) const {
    const auto motion = held_stamp_ ? motion_.odometry_between(*held_stamp_, stamp) : std::nullopt;
    if (!motion) return false;
    result.drift_m = largest_sigma(motion->covariance, 0);
    result.drift_rad = largest_sigma(motion->covariance, 3);
    return true;
  }

  // Far enough from the reference for another key-frame.
  bool has_moved(const Pose& T_reference_camera) const {
    KeyframeEvidence evidence;
    evidence.frames_since_keyframe = frames_since_keyframe_;
    evidence.T_reference_camera = T_reference_camera;
    return needs_keyframe(config_.keyframe, evidence);
  }

  bool shows_surfaces(const Frame& frame) const {
    if (!config_.surface.enabled) return false;
    const auto samples = sample_surface(config_.surface, config_.noise, frame.input->camera, frame.input->depth);
    return samples.size() >= static_cast<std::size_t>(config_.surface.min_matches);
  }

  // Near where motion leads, or else anywhere in the map; believed only when motion or the next frames agree.
  TrackOutcome find_pose(const Frame& frame) {
    awaits_confirmation_ = false;
    TrackOutcome outcome = tracker_.track(map_, frame, motion_.predict(map_, frame.input->stamp));
    if (!outcome.is_tracked) {
      TrackOutcome found = relocalizer_.search(map_, loops_, tracker_, frame);
      if (!found.is_tracked) return outcome;
      outcome = std::move(found);
    }
    if (relocalizer_.believes({map_, graph_, motion_, frame, is_contradicted()}, outcome)) return outcome;
    outcome.is_tracked = false;
    outcome.reason = "a recognised place awaits confirmation";
    awaits_confirmation_ = true;
    return outcome;
  }

  // When there is enough to see, and odometry says where, the map continues there; surfaces that nobody has seen yet
  // become a key-frame's, so that the next frames can be aligned with them.
  TrackingResult continue_blind(const Frame& frame, const std::string& reason, bool is_new_view) {
    TrackingResult result = without_vision(frame.input->stamp, reason, &frame);
    if (result.state != TrackingState::kDeadReckoning) return result;
    const bool begins_anew = blind_frames_ >= config_.tracker.max_blind_frames && contradictions_ == 0;
    if (!begins_anew && !(is_new_view && has_moved(result.T_keyframe_camera) && shows_surfaces(frame))) return result;
    if (begins_anew) {
      blind_frames_ = 0;
      result.state = TrackingState::kTracking;
      result.reason.clear();
    }
    insert_keyframe(frame, nullptr, result);
    motion_.update(map_, frame.input->stamp, {result.keyframe_id, result.T_keyframe_camera, result.covariance});
    return result;
  }

  void set_pose(const RelativeCamera& camera, TrackingResult& result) const {
    result.keyframe_id = camera.reference;
    result.T_map_keyframe = map_.keyframe(camera.reference).T_map_camera;
    result.T_keyframe_camera = camera.T_reference_camera;
    result.covariance = camera.covariance;
    result.map_covariance =
        compound_covariance(graph_.covariance(camera.reference), camera.T_reference_camera, camera.covariance);
  }

  TrackingResult with_pose(const Frame& frame, const TrackOutcome& outcome) const {
    TrackingResult result;
    result.state = TrackingState::kTracking;
    result.graph_version = version_;
    const RelativeCamera seen{outcome.reference, outcome.alignment.T_reference_camera,
                              edge_information(config_.pose_graph, outcome.alignment.information).inverse()};
    auto reckoned = motion_.dead_reckon(frame.input->stamp);
    if (reckoned && graph_.are_apart(reckoned->reference, seen.reference)) reckoned.reset();  // it leads astray
    set_pose(fuse(seen, reckoned), result);
    result.features = static_cast<std::uint32_t>(frame.features.size());
    result.matches = static_cast<std::uint32_t>(outcome.matches);
    result.inliers = static_cast<std::uint32_t>(outcome.alignment.inliers);
    result.rms_px = outcome.alignment.rms_px;
    return result;
  }

  // Vision and odometry together, each as sure as it is: a bare wall says nothing of the path along it. Odometry of
  // wheels that slip loses its weight (Huber).
  RelativeCamera fuse(const RelativeCamera& seen, const std::optional<RelativeCamera>& reckoned) const {
    constexpr double kMostSigmas = 3.0;
    if (!reckoned) return seen;
    const Pose T_map_reckoned = map_.keyframe(reckoned->reference).T_map_camera * reckoned->T_reference_camera;
    const Pose T_map_seen = map_.keyframe(seen.reference).T_map_camera * seen.T_reference_camera;
    const geometry::Vector6d difference = geometry::se3_log(T_map_seen.inverse() * T_map_reckoned);
    const Matrix6d sum = seen.covariance + reckoned->covariance;
    const double sigmas = std::sqrt(difference.dot(sum.inverse() * difference));
    const Matrix6d odometry = std::min(1.0, kMostSigmas / sigmas) * reckoned->covariance.inverse();
    const Matrix6d together = (seen.covariance.inverse() + odometry).inverse();
    return {seen.reference, seen.T_reference_camera * geometry::se3_exp(together * odometry * difference), together};
  }

  TrackingResult start_map(const Frame& frame) {
    // Without odometry a map of few features, or of surfaces, would be lost for ever as soon as they tell too little.
    const bool has_odometry = motion_.odometry_at(frame.input->stamp).has_value();
    const int alone = std::min(config_.tracker.min_first_features, config_.features.max_features / 2);
    const int least = config_.tracker.min_matches;
    const int needed = has_odometry ? least : std::max(least, alone);
    const bool has_features = frame.features_with_depth >= needed;
    if (!has_features && !(has_odometry && shows_surfaces(frame))) {
      return without_vision(
          frame.input->stamp,
          "the view shows too little to begin (a blank wall?): " + std::to_string(frame.features_with_depth) +
              " features with depth, " + std::to_string(needed) + " needed" +
              (has_odometry ? ", and too few surfaces" : "; without odometry, surfaces are not enough to begin"),
          &frame);
    }
    const KeyframeId id = add_keyframe(frame, T_map_first_camera_);
    graph_.add_root();
    loops_.add(map_, graph_, tracker_, frame, id);
    add_landmarks(id);
    tracker_.set_reference(map_, id);
    motion_.update(map_, frame.input->stamp, {id, Pose::Identity(), Matrix6d::Zero()});
    held_stamp_ = frame.input->stamp;
    TrackingResult result;
    result.state = TrackingState::kTracking;
    result.source = has_features ? PoseSource::kVision : PoseSource::kSurfaces;
    result.features = static_cast<std::uint32_t>(frame.features.size());
    become_keyframe(id, result);
    return result;
  }

  // After a recovery the camera may be beside another key-frame than the one tracked last.
  void follow_reference(const TrackOutcome& outcome) {
    if (outcome.reference != reference_) tracker_.set_reference(map_, outcome.reference);
    reference_ = outcome.reference;
  }

  KeyframeEvidence evidence(const TrackOutcome& outcome) const {
    const auto& landmarks = map_.keyframe(outcome.reference).landmarks;
    KeyframeEvidence evidence;
    evidence.frames_since_keyframe = frames_since_keyframe_;
    evidence.T_reference_camera = outcome.alignment.T_reference_camera;
    std::vector<LandmarkId> known;
    for (const LandmarkId id : landmarks) {
      if (id != kNoLandmark) known.push_back(id);
    }
    std::sort(known.begin(), known.end());
    evidence.reference_landmarks = static_cast<int>(known.size());
    evidence.tracked_landmarks =
        static_cast<int>(std::count_if(outcome.inliers.begin(), outcome.inliers.end(), [&](const Match& match) {
          return std::binary_search(known.begin(), known.end(), match.landmark);
        }));
    return evidence;
  }

  // Landmarks, edges, local bundle adjustment; afterwards the frame is its own reference. `outcome`: how it was
  // tracked, null when only odometry knows its pose.
  void insert_keyframe(const Frame& frame, const TrackOutcome* outcome, TrackingResult& result) {
    const KeyframeId previous = map_.keyframes().back().id;
    const KeyframeId id = add_keyframe(frame, result.T_map_keyframe * result.T_keyframe_camera);
    const EdgeType type = outcome == nullptr                       ? EdgeType::kWheelOdometry
                          : result.source == PoseSource::kSurfaces ? EdgeType::kSurface
                                                                   : EdgeType::kOdometry;
    const Pose T_parent_keyframe =
        outcome != nullptr ? outcome->alignment.T_reference_camera : result.T_keyframe_camera;
    const Matrix6d information = outcome != nullptr
                                     ? edge_information(config_.pose_graph, outcome->alignment.information)
                                     : bounded_information(config_.pose_graph, result.covariance.inverse());
    const PoseGraphEdge edge{result.keyframe_id, id, type, T_parent_keyframe, information};
    graph_.add_keyframe(edge, type == EdgeType::kSurface ? result.covariance : Matrix6d(information.inverse()));
    if (outcome != nullptr) {
      for (const Match& match : outcome->inliers) map_.add_observation(match.landmark, {id, match.feature});
      graph_.add_link(
          {outcome->reference, id, outcome->alignment.T_reference_camera, outcome->alignment.surface_information});
      if (previous >= saved_keyframes_) add_odometry_edge(previous, id, *outcome);
    }
    add_landmarks(id);
    graph_.follow(map_, adjust_local_map(config_, graph_.links(), map_));
    close_loops(frame, id);
    tracker_.set_reference(map_, id);
    become_keyframe(id, result);
  }

  void close_loops(const Frame& frame, KeyframeId id) {
    const std::vector<PoseGraphEdge> found = loops_.add(map_, graph_, tracker_, frame, id);
    for (const PoseGraphEdge& loop : found) graph_.add_edge(loop);
    if (found.empty()) return;
    last_loop_ = frame.input->stamp;
    must_optimize_ = true;
    optimize();
  }

  void optimize() {
    if (!must_optimize_ || worker_.is_busy()) return;
    must_optimize_ = false;
    worker_.start(pose_graph(), frame_count_ + static_cast<std::uint64_t>(config_.loop.latency_frames));
  }

  void correct(const GraphCorrection& correction) {
    graph_.apply(correction, map_);
    tracker_.set_reference(map_, reference_);
    ++version_;
    optimize();
  }

  // Odometry of wheels that slipped is left out: vision is sure of its pose, and odometry gives another one. But where
  // the path between is of odometry alone, it is that path which is wrong, and its circle has to close.
  void add_odometry_edge(KeyframeId from, KeyframeId to, const TrackOutcome& outcome) {
    const time::Time from_stamp = map_.keyframe(from).stamp, to_stamp = map_.keyframe(to).stamp;
    const Matrix6d covariance = edge_information(config_.pose_graph, outcome.alignment.information).inverse();
    const bool vision_is_sure = outcome.alignment.inliers >= config_.tracker.min_matches;
    if (vision_is_sure && outcome.reference == from) {
      motion_.learn_wheels(from_stamp, to_stamp, outcome.alignment.T_reference_camera, covariance);
    }
    const auto motion = motion_.odometry_between(from_stamp, to_stamp);
    motion_.forget_before(to_stamp);
    if (!motion) return;
    const Matrix6d information = bounded_information(config_.pose_graph, motion->covariance.inverse());
    const PoseGraphEdge edge{from, to, EdgeType::kWheelOdometry, motion->T_from_to, information};
    if (graph_.are_apart(from, outcome.reference)) return graph_.add_edge(edge);
    const Pose T_from_to = map_.keyframe(from).T_map_camera.inverse() * map_.keyframe(to).T_map_camera;
    if (vision_is_sure && disagreement(*motion, T_from_to, covariance) > config_.odometry.max_disagreement) {
      ++slips_;
      return;
    }
    graph_.add_edge(edge);
    graph_.add_link({from, to, motion->T_from_to, information});
  }

  void become_keyframe(KeyframeId id, TrackingResult& result) {
    reference_ = id;
    frames_since_keyframe_ = 0;
    ++version_;
    result.is_keyframe = true;
    result.keyframe_id = id;
    result.graph_version = version_;
    result.T_map_keyframe = map_.keyframe(id).T_map_camera;
    result.T_keyframe_camera = Pose::Identity();
    result.covariance = Matrix6d::Zero();
  }

  KeyframeId add_keyframe(const Frame& frame, const Pose& T_map_camera) {
    const RgbdFrame& input = *frame.input;
    Keyframe keyframe;
    keyframe.stamp = input.stamp;
    keyframe.camera = input.camera;
    keyframe.T_map_camera = geometry::make_pose(T_map_camera.translation(), Eigen::Quaterniond(T_map_camera.linear()));
    keyframe.features = frame.features;
    if (config_.surface.enabled) {
      keyframe.surface = sample_surface(config_.surface, config_.noise, input.camera, input.depth);
    }
    return map_.add_keyframe(std::move(keyframe));
  }

  // A landmark for every feature with depth that shows none yet.
  void add_landmarks(KeyframeId id) {
    for (std::size_t i = 0; i < map_.keyframe(id).features.size(); ++i) {
      const Keyframe& keyframe = map_.keyframe(id);
      const Feature& feature = keyframe.features[i];
      if (feature.depth_m <= 0.0 || keyframe.landmarks[i] != kNoLandmark) continue;
      const Eigen::Vector3d p = keyframe.camera.unproject(feature.pixel.x(), feature.pixel.y(), feature.depth_m);
      const double finest_m = finest_distance(config_.features, p.norm(), feature.octave);
      map_.add_observation(map_.add_landmark(keyframe.T_map_camera * p, finest_m), {id, static_cast<int>(i)});
    }
  }

  SlamConfig config_;
  Pose T_map_first_camera_;
  FeatureExtractor extractor_;
  Tracker tracker_;
  MotionModel motion_;
  Map map_;
  SlamGraph graph_;
  LoopDetector loops_;
  Relocalizer relocalizer_;
  SurfaceTracker surfaces_;
  GraphWorker worker_;
  std::optional<time::Time> last_loop_;
  bool must_optimize_ = false;  // there are loops that no optimisation knows
  KeyframeId reference_ = 0;
  std::uint64_t frame_count_ = 0;
  int frames_since_keyframe_ = 0;
  std::size_t slips_ = 0;
  int blind_frames_ = 0;                  // in a row, with enough to see
  int contradictions_ = 0;                // in a row, of surfaces with odometry
  int fits_ = 0;                          // in a row, of the same
  std::optional<time::Time> held_stamp_;  // of the newest pose by vision or surfaces
  bool has_odometry_ = false;
  bool awaits_confirmation_ = false;  // a place was recognised in the newest frame, and is not believed yet
  std::uint64_t version_ = 0;
  std::size_t saved_keyframes_ = 0;  // their stamps are of another time: no odometry leads from them
  bool is_placed_ = true;            // in a saved map: false until the camera has been found there
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
PoseGraphSnapshot RgbdSlam::pose_graph() const { return implementation_->pose_graph(); }
SlamState RgbdSlam::state() const { return implementation_->state(); }
std::uint64_t RgbdSlam::graph_version() const { return implementation_->version(); }
std::size_t RgbdSlam::keyframe_count() const { return implementation_->keyframe_count(); }
std::size_t RgbdSlam::landmark_count() const { return implementation_->landmark_count(); }
const Map& RgbdSlam::map() const { return implementation_->map(); }
std::size_t RgbdSlam::slip_count() const { return implementation_->slip_count(); }
std::optional<WheelCalibration> RgbdSlam::wheels() const { return implementation_->wheels(); }
std::size_t RgbdSlam::places_doubted() const { return implementation_->places_doubted(); }

}  // namespace lapis::slam
