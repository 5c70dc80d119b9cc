#include "slam/core/rgbd_slam.hpp"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include "slam/core/keyframe_rule.hpp"
#include "slam/core/local_bundle.hpp"
#include "slam/core/motion_model.hpp"
#include "slam/core/noise_model.hpp"
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
        motion_(config.tracker.max_prediction_s, config.odometry, T_base_camera) {}

  bool add_odometry(time::Time stamp, const Pose& T_odom_base) { return motion_.add_odometry(stamp, T_odom_base); }

  TrackingResult process(const RgbdFrame& input) {
    if (const auto fault = find_fault(input, config_.noise)) return without_vision(input.stamp, *fault);
    const Frame frame = make_frame(input, extractor_, config_.noise);
    if (map_.empty()) return start_map(frame);

    TrackOutcome outcome = tracker_.track(map_, frame, motion_.predict(map_, input.stamp));
    if (!outcome.is_tracked) return continue_blind(frame, outcome.reason);
    blind_frames_ = 0;
    ++frames_since_keyframe_;
    follow_reference(outcome);
    TrackingResult result = with_pose(frame, outcome);
    if (needs_keyframe(config_.keyframe, evidence(outcome))) insert_keyframe(frame, &outcome, result);
    motion_.update(map_, input.stamp, {result.keyframe_id, result.T_keyframe_camera, result.covariance});
    return result;
  }

  std::optional<Pose> odometry_at(time::Time stamp) const { return motion_.odometry_at(stamp); }

  PoseGraphSnapshot pose_graph() const {
    PoseGraphSnapshot snapshot{version_, {}, edges_};
    for (const Keyframe& keyframe : map_.keyframes()) {
      snapshot.nodes.push_back({keyframe.id, keyframe.stamp, keyframe.T_map_camera});
    }
    return snapshot;
  }

  std::uint64_t version() const { return version_; }
  std::size_t keyframe_count() const { return map_.keyframes().size(); }
  std::size_t landmark_count() const { return map_.landmark_count(); }
  std::size_t slip_count() const { return slips_; }
  TrackingResult without_vision(time::Time stamp, const std::string& reason, const Frame* frame = nullptr) const {
    TrackingResult result;
    result.state = map_.empty() ? TrackingState::kInitializing : TrackingState::kLost;
    result.reason = reason;
    result.graph_version = version_;
    if (frame != nullptr) result.features = static_cast<std::uint32_t>(frame->features.size());
    const auto reckoned = motion_.dead_reckon(stamp);
    if (!reckoned) return result;
    result.state = TrackingState::kDeadReckoning;
    set_pose(*reckoned, result);
    return result;
  }

 private:
  // The view has changed altogether, or there is nothing to see. When there is, and the wheels tell where, the map goes
  // on from there.
  TrackingResult continue_blind(const Frame& frame, const std::string& reason) {
    TrackingResult result = without_vision(frame.input->stamp, reason, &frame);
    const bool could_start = frame.features_with_depth >= config_.tracker.min_matches;
    blind_frames_ = could_start ? blind_frames_ + 1 : 0;
    if (result.state != TrackingState::kDeadReckoning || blind_frames_ < config_.tracker.max_blind_frames)
      return result;
    result.state = TrackingState::kTracking;
    result.reason.clear();
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
        compound_covariance(covariances_[camera.reference], camera.T_reference_camera, camera.covariance);
  }

  TrackingResult with_pose(const Frame& frame, const TrackOutcome& outcome) const {
    TrackingResult result;
    result.state = TrackingState::kTracking;
    result.graph_version = version_;
    set_pose({outcome.reference, outcome.alignment.T_reference_camera,
              edge_information(config_.pose_graph, outcome.alignment.information).inverse()},
             result);
    result.features = static_cast<std::uint32_t>(frame.features.size());
    result.matches = static_cast<std::uint32_t>(outcome.matches);
    result.inliers = static_cast<std::uint32_t>(outcome.alignment.inliers);
    result.rms_px = outcome.alignment.rms_px;
    return result;
  }

  TrackingResult start_map(const Frame& frame) {
    if (frame.features_with_depth < config_.tracker.min_matches) {
      return without_vision(frame.input->stamp,
                            std::to_string(frame.features_with_depth) + " features with depth, " +
                                std::to_string(config_.tracker.min_matches) + " needed",
                            &frame);
    }
    const KeyframeId id = add_keyframe(frame, T_map_first_camera_);
    covariances_.emplace_back(Matrix6d::Zero());
    add_landmarks(id);
    tracker_.set_reference(map_, id);
    motion_.update(map_, frame.input->stamp, {id, Pose::Identity(), Matrix6d::Zero()});
    TrackingResult result;
    result.state = TrackingState::kTracking;
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
    covariances_.push_back(result.map_covariance);
    if (outcome != nullptr) {
      for (const Match& match : outcome->inliers) map_.add_observation(match.landmark, {id, match.feature});
      add_visual_edge(id, *outcome);
      add_wheel_edge(previous, id, *outcome);
    } else {
      edges_.push_back({result.keyframe_id, id, EdgeType::kWheelOdometry, result.T_keyframe_camera,
                        bounded_information(config_.pose_graph, result.covariance.inverse())});
    }
    add_landmarks(id);
    adjust_local_map(config_, links_, map_);
    tracker_.set_reference(map_, id);
    become_keyframe(id, result);
  }

  void add_visual_edge(KeyframeId id, const TrackOutcome& outcome) {
    const Alignment& alignment = outcome.alignment;
    edges_.push_back({outcome.reference, id, EdgeType::kOdometry, alignment.T_reference_camera,
                      edge_information(config_.pose_graph, alignment.information)});
    links_.push_back({outcome.reference, id, alignment.T_reference_camera, alignment.surface_information});
  }

  // Wheels that slipped are left out: vision is sure of its pose, and theirs is another one.
  void add_wheel_edge(KeyframeId from, KeyframeId to, const TrackOutcome& outcome) {
    const auto motion = motion_.odometry_between(map_.keyframe(from).stamp, map_.keyframe(to).stamp);
    motion_.forget_before(map_.keyframe(to).stamp);
    if (!motion) return;
    const Pose T_from_to = map_.keyframe(from).T_map_camera.inverse() * map_.keyframe(to).T_map_camera;
    const Matrix6d covariance = edge_information(config_.pose_graph, outcome.alignment.information).inverse();
    const bool vision_is_sure = outcome.alignment.inliers >= config_.tracker.min_matches;
    if (vision_is_sure && disagreement(*motion, T_from_to, covariance) > config_.odometry.max_disagreement) {
      ++slips_;
      return;
    }
    const Matrix6d information = bounded_information(config_.pose_graph, motion->covariance.inverse());
    edges_.push_back({from, to, EdgeType::kWheelOdometry, motion->T_from_to, information});
    links_.push_back({from, to, motion->T_from_to, information});
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
    keyframe.T_map_camera = T_map_camera;
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
  std::vector<PoseGraphEdge> edges_;
  std::vector<KeyframeLink> links_;
  std::vector<Matrix6d> covariances_;  // of each key-frame's pose in the map
  KeyframeId reference_ = 0;
  int frames_since_keyframe_ = 0;
  std::size_t slips_ = 0;
  int blind_frames_ = 0;  // in a row, with enough to see
  std::uint64_t version_ = 0;
};

RgbdSlam::RgbdSlam(const SlamConfig& config, const Pose& T_map_first_camera, const Pose& T_base_camera)
    : implementation_(std::make_unique<Implementation>(config, T_map_first_camera, T_base_camera)) {}
RgbdSlam::~RgbdSlam() = default;

TrackingResult RgbdSlam::process(const RgbdFrame& frame) { return implementation_->process(frame); }
bool RgbdSlam::add_odometry(time::Time stamp, const Pose& T_odom_base) {
  return implementation_->add_odometry(stamp, T_odom_base);
}
std::optional<Pose> RgbdSlam::odometry_at(time::Time stamp) const { return implementation_->odometry_at(stamp); }
TrackingResult RgbdSlam::skip(time::Time stamp, const std::string& reason) const {
  return implementation_->without_vision(stamp, reason);
}
PoseGraphSnapshot RgbdSlam::pose_graph() const { return implementation_->pose_graph(); }
std::uint64_t RgbdSlam::graph_version() const { return implementation_->version(); }
std::size_t RgbdSlam::keyframe_count() const { return implementation_->keyframe_count(); }
std::size_t RgbdSlam::landmark_count() const { return implementation_->landmark_count(); }
std::size_t RgbdSlam::slip_count() const { return implementation_->slip_count(); }

}  // namespace lapis::slam
