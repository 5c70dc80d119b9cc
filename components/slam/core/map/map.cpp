#include "slam/core/map/map.hpp"

#include <algorithm>
#include <utility>

namespace lapis::slam {

KeyframeId Map::add_keyframe(Keyframe keyframe) {
  keyframe.id = keyframes_.size();
  keyframe.landmarks.assign(keyframe.features.size(), kNoLandmark);
  keyframes_.push_back(std::move(keyframe));
  return keyframes_.back().id;
}

LandmarkId Map::add_landmark(const Eigen::Vector3d& p_map, double finest_distance_m) {
  landmarks_.push_back({p_map, {}, finest_distance_m, {}});
  return static_cast<LandmarkId>(landmarks_.size() - 1);
}

bool Map::add_observation(LandmarkId landmark, const Observation& observation) {
  Keyframe& keyframe = keyframes_[static_cast<std::size_t>(observation.keyframe)];
  const auto feature = static_cast<std::size_t>(observation.feature);
  auto& observations = landmarks_[landmark].observations;
  const bool seen = std::any_of(observations.begin(), observations.end(),
                                [&](const Observation& o) { return o.keyframe == observation.keyframe; });
  if (seen || keyframe.landmarks[feature] != kNoLandmark) return false;
  if (observations.empty()) ++alive_;
  observations.push_back(observation);
  keyframe.landmarks[feature] = landmark;
  landmarks_[landmark].descriptor = keyframe.features[feature].descriptor;
  return true;
}

void Map::remove_observation(LandmarkId landmark, const Observation& observation) {
  auto& observations = landmarks_[landmark].observations;
  const auto removed = std::erase_if(observations, [&](const Observation& o) {
    return o.keyframe == observation.keyframe && o.feature == observation.feature;
  });
  if (removed == 0) return;
  keyframes_[static_cast<std::size_t>(observation.keyframe)].landmarks[static_cast<std::size_t>(observation.feature)] =
      kNoLandmark;
  if (observations.empty()) --alive_;
}

void Map::set_pose(KeyframeId id, const geometry::Pose& T_map_camera) {
  keyframes_[static_cast<std::size_t>(id)].T_map_camera = T_map_camera;
}

void Map::move(const std::vector<geometry::Pose>& moves) {
  for (Keyframe& keyframe : keyframes_) {
    const geometry::Pose moved = moves[static_cast<std::size_t>(keyframe.id)] * keyframe.T_map_camera;
    // Normalises the rotation: its rounding error would treble with every move that was computed from the pose itself.
    keyframe.T_map_camera = geometry::make_pose(moved.translation(), Eigen::Quaterniond(moved.linear()));
  }
  for (Landmark& landmark : landmarks_) {
    if (landmark.observations.empty()) continue;
    landmark.p_map = moves[static_cast<std::size_t>(landmark.observations.front().keyframe)] * landmark.p_map;
  }
}

void Map::change_focal_length(double ratio) {
  const Eigen::Vector3d beside(1.0 / ratio, 1.0 / ratio, 1.0);
  for (Landmark& landmark : landmarks_) {
    if (landmark.observations.empty()) continue;
    const geometry::Pose& T_map_camera = keyframe(landmark.observations.front().keyframe).T_map_camera;
    const Eigen::Vector3d before = T_map_camera.inverse() * landmark.p_map;
    const Eigen::Vector3d after = before.cwiseProduct(beside);
    landmark.p_map = T_map_camera * after;
    landmark.finest_distance_m *= after.norm() / before.norm();
  }
  for (Keyframe& keyframe : keyframes_) {
    keyframe.camera.fx *= ratio;
    keyframe.camera.fy *= ratio;
    std::vector<SurfaceSample> surface = keyframe.surface;
    for (SurfaceSample& sample : surface) {
      sample.point = sample.point.cwiseProduct(beside);
      sample.normal = sample.normal.cwiseQuotient(beside).normalized();
    }
    keyframe.surface = std::move(surface);
  }
}

void Map::renew_depth(KeyframeId id, std::vector<Feature> features, std::vector<SurfaceSample> surface) {
  Keyframe& keyframe = keyframes_[static_cast<std::size_t>(id)];
  for (std::size_t i = 0; i < features.size(); ++i) {
    if (keyframe.landmarks[i] == kNoLandmark || features[i].depth_m <= 0.0) continue;
    Landmark& landmark = landmarks_[keyframe.landmarks[i]];
    if (landmark.observations.front().keyframe != id) continue;
    const Eigen::Vector2d& pixel = features[i].pixel;
    const Eigen::Vector3d p = keyframe.camera.unproject(pixel.x(), pixel.y(), features[i].depth_m);
    landmark.finest_distance_m *= p.norm() / (keyframe.T_map_camera.inverse() * landmark.p_map).norm();
    landmark.p_map = keyframe.T_map_camera * p;
  }
  keyframe.features = std::move(features);
  keyframe.surface = std::move(surface);
}

void Map::join(KeyframeId sub_map, KeyframeId into, const geometry::Pose& T_into_sub_map) {
  std::vector<geometry::Pose> moves(keyframes_.size(), geometry::Pose::Identity());
  for (Keyframe& keyframe : keyframes_) {
    if (keyframe.sub_map != sub_map) continue;
    moves[static_cast<std::size_t>(keyframe.id)] = T_into_sub_map;
    keyframe.sub_map = into;
  }
  move(moves);
}

void Map::clear(KeyframeId sub_map) {
  for (Keyframe& keyframe : keyframes_) {
    if (keyframe.sub_map != sub_map) continue;
    for (std::size_t i = 0; i < keyframe.landmarks.size(); ++i) {
      if (keyframe.landmarks[i] == kNoLandmark) continue;
      remove_observation(keyframe.landmarks[i], {keyframe.id, static_cast<int>(i)});
    }
    keyframe.features = {};
    keyframe.landmarks.clear();
    keyframe.surface = {};
  }
}

std::vector<KeyframeId> Map::covisible(KeyframeId id, std::size_t most) const {
  std::vector<std::size_t> shared(keyframes_.size(), 0);
  for (const LandmarkId landmark : keyframe(id).landmarks) {
    if (landmark == kNoLandmark) continue;
    for (const Observation& observation : landmarks_[landmark].observations) {
      ++shared[static_cast<std::size_t>(observation.keyframe)];
    }
  }
  std::vector<KeyframeId> found;
  for (KeyframeId other = 0; other < shared.size(); ++other) {
    if (other != id && shared[static_cast<std::size_t>(other)] > 0) found.push_back(other);
  }
  std::sort(found.begin(), found.end(), [&](KeyframeId a, KeyframeId b) {
    return std::pair(shared[static_cast<std::size_t>(a)], a) > std::pair(shared[static_cast<std::size_t>(b)], b);
  });
  found.resize(std::min(found.size(), most));
  return found;
}

std::vector<LandmarkId> Map::landmarks_of(const std::vector<KeyframeId>& keyframes) const {
  std::vector<LandmarkId> found;
  for (const KeyframeId id : keyframes) {
    for (const LandmarkId landmark : keyframe(id).landmarks) {
      if (landmark != kNoLandmark) found.push_back(landmark);
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace lapis::slam
