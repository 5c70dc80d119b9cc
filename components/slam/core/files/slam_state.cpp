#include "slam/core/files/slam_state.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace lapis::slam {
namespace {

using geometry::Matrix6d;

using Fault = std::optional<std::string>;

constexpr int kMostOctaves = 32;
constexpr double kNormalTolerance = 1e-3;  // of a normal's length

template <class Part, class Check>
Fault first_fault(const std::vector<Part>& parts, const std::string& name, Check check) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (const Fault fault = check(parts[i])) return name + " " + std::to_string(i) + ": " + *fault;
  }
  return std::nullopt;
}

bool is_stamp(time::Time stamp) { return stamp.nanoseconds >= 0 && stamp.nanoseconds <= kLastStamp_ns; }
bool is_covariance(const Matrix6d& m) { return m.allFinite() && m.diagonal().minCoeff() >= 0.0; }

Fault find_feature_fault(const Keyframe& keyframe, const Feature& feature) {
  if (!feature.pixel.allFinite() || !keyframe.camera.contains(feature.pixel)) return "pixel outside of the image";
  if (feature.octave < 0 || feature.octave >= kMostOctaves) return "octave " + std::to_string(feature.octave);
  if (!std::isfinite(feature.depth_m) || feature.depth_m < 0.0) return "depth out of range";
  return std::nullopt;
}

Fault find_surface_fault(const SurfaceSample& sample) {
  if (!sample.point.allFinite()) return "point is not finite";
  if (!(std::abs(sample.normal.norm() - 1.0) < kNormalTolerance)) return "normal has not length 1";
  return std::nullopt;
}

// Fault of the landmarks that a key-frame shows: each has to exist, and none may occur twice.
Fault find_link_fault(const Keyframe& keyframe, std::size_t landmarks) {
  if (keyframe.landmarks.size() != keyframe.features.size()) return "its features and their landmarks differ in number";
  std::vector<LandmarkId> shown;
  for (const LandmarkId id : keyframe.landmarks) {
    if (id == kNoLandmark) continue;
    if (id >= landmarks) return "landmark " + std::to_string(id) + " does not exist";
    shown.push_back(id);
  }
  std::sort(shown.begin(), shown.end());
  const auto twice = std::adjacent_find(shown.begin(), shown.end());
  if (twice != shown.end()) return "two features show landmark " + std::to_string(*twice);
  return std::nullopt;
}

Fault find_keyframe_fault(const Keyframe& keyframe, std::size_t landmarks) {
  if (!is_stamp(keyframe.stamp)) return "stamp out of range";
  if (!geometry::is_valid(keyframe.camera)) return "invalid camera";
  if (!geometry::is_valid(keyframe.T_map_camera)) return "pose is no rigid transform";
  if (auto fault = find_link_fault(keyframe, landmarks)) return fault;
  const auto check = [&](const Feature& feature) { return find_feature_fault(keyframe, feature); };
  if (auto fault = first_fault<Feature>(keyframe.features, "feature", check)) return fault;
  return first_fault<SurfaceSample>(keyframe.surface, "surface sample", find_surface_fault);
}

Fault find_landmark_fault(const LandmarkState& landmark) {
  if (!landmark.p_map.allFinite()) return "position is not finite";
  if (!std::isfinite(landmark.finest_distance_m) || landmark.finest_distance_m <= 0.0) return "distance out of range";
  return std::nullopt;
}

// Each part of the map is named by its first key-frame, and edges are within a part.
Fault find_part_fault(const SlamState& state) {
  const auto& parts = state.parts;
  if (parts.empty()) return std::nullopt;
  if (parts.size() != state.keyframes.size()) return "their number is not that of the key-frames";
  const auto part = [&](KeyframeId id) { return parts[static_cast<std::size_t>(id)]; };
  for (KeyframeId id = 0; id < parts.size(); ++id) {
    if (part(id) > id || part(part(id)) != part(id)) return "that of key-frame " + std::to_string(id) + " has no name";
  }
  const bool are_apart = std::all_of(state.edges.begin(), state.edges.end(),
                                     [&](const PoseGraphEdge& edge) { return part(edge.from) == part(edge.to); });
  if (!are_apart) return "an edge connects two of them";
  return std::nullopt;
}

// Fault of an edge or a link.
template <class Relation>
Fault find_relation_fault(const Relation& relation, std::size_t keyframes) {
  if (relation.from >= keyframes || relation.to >= keyframes) return "joins a key-frame that does not exist";
  if (relation.from == relation.to) return "joins a key-frame with itself";
  if (!geometry::is_valid(relation.T_from_to)) return "pose is no rigid transform";
  if (!is_covariance(relation.information)) return "information is not finite and positive";
  return std::nullopt;
}

Fault find_edge_fault(const PoseGraphEdge& edge, std::size_t keyframes) {
  if (edge.type > EdgeType::kSurface) return "unknown type";
  if (auto fault = find_relation_fault(edge, keyframes)) return fault;
  if (edge.information.llt().info() != Eigen::Success) return "information is not positive definite";
  return std::nullopt;
}

Fault find_wheel_fault(const WheelCalibration& wheels) {
  const auto is_scale = [](double scale, double variance) {
    return scale > 0.0 && std::isfinite(scale) && variance >= 0.0 && std::isfinite(variance);
  };
  if (!is_scale(wheels.distance_scale, wheels.distance_variance) || !is_scale(wheels.turn_scale, wheels.turn_variance))
    return "scale out of range";
  if (!(wheels.noise >= 0.1 && wheels.noise <= 10.0)) return "noise out of range";
  if (!(wheels.motions >= 0.0 && std::isfinite(wheels.motions))) return "number of motions out of range";
  return std::nullopt;
}

Fault find_motion_fault(const SavedMotion& motion, std::size_t keyframes) {
  if (!is_stamp(motion.stamp) || !is_stamp(motion.held_stamp)) return "stamp out of range";
  if (motion.camera.reference >= keyframes) return "its key-frame does not exist";
  if (!geometry::is_valid(motion.camera.T_reference_camera)) return "pose is no rigid transform";
  if (!is_covariance(motion.camera.covariance)) return "covariance is not finite and positive";
  const auto is_usable = [](const OdometryReading& reading) {
    return is_stamp(reading.stamp) && geometry::is_valid(reading.T_odom_base);
  };
  if (!std::all_of(motion.odometry.begin(), motion.odometry.end(), is_usable)) return "odometry that is not valid";
  return std::nullopt;
}

}  // namespace

Fault find_fault(const SlamState& state) {
  const std::size_t keyframes = state.keyframes.size();
  const std::size_t landmarks = state.landmarks.size();
  if (keyframes == 0) return "no key-frames";
  if (state.graph_version == 0) return "graph version 0 with key-frames";
  if (state.reference >= keyframes) return "the reference key-frame does not exist";
  if (!(state.scale_factor > 1.0 && std::isfinite(state.scale_factor))) return "scale factor out of range";
  if (state.covariances.size() != keyframes) return "key-frames and covariances differ in number";
  for (std::size_t i = 0; i < keyframes; ++i) {
    if (state.keyframes[i].id != i) return "key-frame " + std::to_string(i) + ": wrong id";
  }
  if (auto fault = find_wheel_fault(state.wheels)) return "calibration of the wheels: " + *fault;
  if (auto fault = state.motion ? find_motion_fault(*state.motion, keyframes) : Fault{}) return "motion: " + *fault;
  const auto check_keyframe = [&](const Keyframe& k) { return find_keyframe_fault(k, landmarks); };
  if (auto fault = first_fault(state.keyframes, "key-frame", check_keyframe)) return fault;
  if (auto fault = first_fault(state.landmarks, "landmark", find_landmark_fault)) return fault;
  const auto check_edge = [&](const PoseGraphEdge& e) { return find_edge_fault(e, keyframes); };
  if (auto fault = first_fault(state.edges, "edge", check_edge)) return fault;
  if (auto fault = find_part_fault(state)) return "parts of the map: " + *fault;
  const auto check_link = [&](const KeyframeLink& l) { return find_relation_fault(l, keyframes); };
  if (auto fault = first_fault(state.links, "link", check_link)) return fault;
  return first_fault(state.covariances, "covariance", [](const Matrix6d& m) -> Fault {
    if (!is_covariance(m)) return "is not finite and positive";
    return std::nullopt;
  });
}

Map restore_map(const SlamState& state) {
  Map map;
  for (const LandmarkState& landmark : state.landmarks) map.add_landmark(landmark.p_map, landmark.finest_distance_m);
  for (Keyframe keyframe : state.keyframes) {
    if (!state.parts.empty()) keyframe.sub_map = state.parts[static_cast<std::size_t>(keyframe.id)];
    const KeyframeId id = map.add_keyframe(keyframe);
    for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (keyframe.landmarks[i] != kNoLandmark) map.add_observation(keyframe.landmarks[i], {id, static_cast<int>(i)});
    }
  }
  return map;
}

bool is_same_camera(const geometry::PinholeCamera& a, const geometry::PinholeCamera& b) {
  const double tolerance_px = 0.01 * a.width;
  const auto is_near = [&](double x, double y) { return std::abs(x - y) < tolerance_px; };
  return a.width == b.width && a.height == b.height && is_near(a.fx, b.fx) && is_near(a.fy, b.fy) &&
         is_near(a.cx, b.cx) && is_near(a.cy, b.cy);
}

}  // namespace lapis::slam
