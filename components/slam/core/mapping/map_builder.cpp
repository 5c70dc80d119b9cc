#include "slam/core/mapping/map_builder.hpp"

#include <utility>

#include <Eigen/LU>

#include "slam/core/frame/surface.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/mapping/local_bundle.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

using geometry::Matrix6d;
using geometry::Pose;

KeyframeId MapBuilder::begin(const Model& model, const Frame& frame, const Pose& T_map_camera) const {
  const KeyframeId id = add_keyframe(model.map, model.map.keyframes().size(), frame, T_map_camera);
  model.graph.add_root();
  add_landmarks(model.map, id);
  return id;
}

KeyframeId MapBuilder::extend(const Model& model, const Frame& frame, const FrameOutcome& outcome) {
  auto& [map, graph, motion] = model;
  const TrackingResult& result = outcome.result;
  const KeyframeId previous = map.keyframes().back().id;
  const KeyframeId sub_map = map.keyframe(result.keyframe_id).sub_map;
  const KeyframeId id = add_keyframe(map, sub_map, frame, result.T_map_keyframe * result.T_keyframe_camera);
  const PoseGraphEdge edge = parent_edge(outcome, id);
  graph.add_keyframe(edge, edge.type == EdgeType::kSurface ? result.covariance : Matrix6d(edge.information.inverse()));
  if (outcome.seen) {
    const TrackOutcome& seen = *outcome.seen;
    for (const Match& match : seen.inliers) map.add_observation(match.landmark, {id, match.feature});
    graph.add_link({seen.reference, id, seen.alignment.T_reference_camera, seen.alignment.surface_information});
    const bool has_path = previous >= saved_keyframes_ && map.keyframe(previous).sub_map == sub_map;
    if (has_path) add_odometry_edge(model, previous, id, seen);
  }
  add_landmarks(map, id);
  graph.follow(map, adjust_local_map(config_, graph.links(), map));
  return id;
}

KeyframeId MapBuilder::add_keyframe(Map& map, KeyframeId sub_map, const Frame& frame, const Pose& T_map_camera) const {
  const RgbdFrame& input = *frame.input;
  Keyframe keyframe;
  keyframe.sub_map = sub_map;
  keyframe.stamp = input.stamp;
  keyframe.camera = input.camera;
  keyframe.T_map_camera = geometry::make_pose(T_map_camera.translation(), Eigen::Quaterniond(T_map_camera.linear()));
  keyframe.features = frame.features;
  if (config_.surface.enabled) {
    keyframe.surface = sample_surface(config_.surface, config_.noise, input.camera, input.depth);
  }
  return map.add_keyframe(std::move(keyframe));
}

// Adds a landmark for every feature with depth that shows none yet.
void MapBuilder::add_landmarks(Map& map, KeyframeId id) const {
  for (std::size_t i = 0; i < map.keyframe(id).features.size(); ++i) {
    const Keyframe& keyframe = map.keyframe(id);
    const Feature& feature = keyframe.features[i];
    if (feature.depth_m <= 0.0 || keyframe.landmarks[i] != kNoLandmark) continue;
    const Eigen::Vector3d p = keyframe.camera.unproject(feature.pixel.x(), feature.pixel.y(), feature.depth_m);
    const double finest_m = finest_distance(config_.features, p.norm(), feature.octave);
    map.add_observation(map.add_landmark(keyframe.T_map_camera * p, finest_m), {id, static_cast<int>(i)});
  }
}

// Edge to the reference key-frame as vision or surfaces measured it, without what odometry added; or of odometry alone.
PoseGraphEdge MapBuilder::parent_edge(const FrameOutcome& outcome, KeyframeId id) const {
  const TrackingResult& result = outcome.result;
  if (!outcome.seen) {
    return {result.keyframe_id, id, EdgeType::kWheelOdometry, result.T_keyframe_camera,
            bounded_information(config_.pose_graph, result.covariance.inverse())};
  }
  const Alignment& alignment = outcome.seen->alignment;
  return {result.keyframe_id, id, result.source == PoseSource::kSurfaces ? EdgeType::kSurface : EdgeType::kOdometry,
          alignment.T_reference_camera, edge_information(config_.pose_graph, alignment.information)};
}

// Adds the edge of odometry between successive key-frames. Odometry is left out where vision is sure of another pose:
// the wheels have slipped. But where odometry alone connects the key-frames between, that stretch is what is wrong, and
// this edge has to close its cycle.
void MapBuilder::add_odometry_edge(const Model& model, KeyframeId from, KeyframeId to, const TrackOutcome& seen) {
  auto& [map, graph, motion] = model;
  const time::Time from_stamp = map.keyframe(from).stamp, to_stamp = map.keyframe(to).stamp;
  const Matrix6d covariance = edge_information(config_.pose_graph, seen.alignment.information).inverse();
  const bool vision_is_sure = seen.alignment.inliers >= config_.tracker.min_matches;
  if (vision_is_sure && seen.reference == from) {
    motion.learn_wheels(from_stamp, to_stamp, seen.alignment.T_reference_camera, covariance);
  }
  const auto reckoned = motion.odometry_between(from_stamp, to_stamp);
  motion.forget_before(to_stamp);
  if (!reckoned) return;
  const Matrix6d information = bounded_information(config_.pose_graph, reckoned->covariance.inverse());
  const PoseGraphEdge edge{from, to, EdgeType::kWheelOdometry, reckoned->T_from_to, information};
  if (graph.are_apart(from, seen.reference)) return graph.add_edge(edge);
  const Pose T_from_to = map.keyframe(from).T_map_camera.inverse() * map.keyframe(to).T_map_camera;
  if (vision_is_sure && disagreement(*reckoned, T_from_to, covariance) > config_.odometry.max_disagreement) {
    ++slips_;
    return;
  }
  graph.add_edge(edge);
  graph.add_link({from, to, reckoned->T_from_to, information});
}

}  // namespace lapis::slam
