#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "common/geometry/se3.hpp"
#include "common/time/time.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/frame/surface.hpp"
#include "slam/core/map/shared_array.hpp"

namespace lapis::slam {

using KeyframeId = std::uint64_t;
using LandmarkId = std::uint32_t;
inline constexpr LandmarkId kNoLandmark = std::numeric_limits<LandmarkId>::max();
/// A part of the map is named by its first key-frame. All parts but this one are sub-maps: nobody knows yet where they
/// are in the map, and their poses and positions are in a frame of their own.
inline constexpr KeyframeId kWholeMap = 0;

/// Feature `feature` of key-frame `keyframe` shows the landmark.
struct Observation {
  KeyframeId keyframe = 0;
  int feature = 0;
};

/// Point of the world that features show.
struct Landmark {
  Eigen::Vector3d p_map = Eigen::Vector3d::Zero();
  Descriptor descriptor{};       ///< of its newest observation
  double finest_distance_m = 0;  ///< distance at which it shows on the finest pyramid level
  std::vector<Observation> observations;
};

/// Frame that stays in the map.
struct Keyframe {
  KeyframeId id = 0;
  time::Time stamp;
  geometry::PinholeCamera camera;
  geometry::Pose T_map_camera = geometry::Pose::Identity();
  SharedArray<Feature> features;
  std::vector<LandmarkId> landmarks;   ///< of each feature, or kNoLandmark
  SharedArray<SurfaceSample> surface;  ///< in this key-frame's optical frame
  KeyframeId sub_map = kWholeMap;      ///< its part of the map
};

/// Key-frames, landmarks and their observations. A key-frame's id is its index; key-frames are never removed.
class Map {
 public:
  /// Adds a key-frame without landmarks; its id is set here and returned.
  KeyframeId add_keyframe(Keyframe keyframe);
  LandmarkId add_landmark(const Eigen::Vector3d& p_map, double finest_distance_m);
  /// Links a feature that shows no landmark yet with one that the key-frame does not show yet; false otherwise.
  bool add_observation(LandmarkId landmark, const Observation& observation);
  /// Removes the link; a landmark without observations is dead and never used again.
  void remove_observation(LandmarkId landmark, const Observation& observation);

  bool empty() const { return keyframes_.empty(); }
  const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  const Keyframe& keyframe(KeyframeId id) const { return keyframes_[static_cast<std::size_t>(id)]; }
  const Landmark& landmark(LandmarkId id) const { return landmarks_[id]; }
  /// All landmarks that ever existed, by id; the dead ones have no observations.
  const std::vector<Landmark>& landmarks() const { return landmarks_; }
  std::size_t landmark_count() const { return alive_; }
  void set_pose(KeyframeId id, const geometry::Pose& T_map_camera);
  /// Moves every key-frame by its transform of the map (T_map_camera becomes moves[id] * T_map_camera), and every
  /// landmark by that of the key-frame that saw it first.
  void move(const std::vector<geometry::Pose>& moves);
  void set_position(LandmarkId id, const Eigen::Vector3d& p_map) { landmarks_[id].p_map = p_map; }
  /// Sees everything anew, as cameras with `ratio` times the focal length that was assumed show it: what is beside the
  /// optical axis is nearer to it, by that ratio. Poses stay.
  void change_focal_length(double ratio);
  /// Gives a key-frame other depths of its features, and other surfaces. Landmarks that it saw first follow; its pose
  /// stays.
  void renew_depth(KeyframeId id, std::vector<Feature> features, std::vector<SurfaceSample> surface);
  /// Makes a sub-map one with another part: its key-frames and landmarks are moved into that one's frame.
  void join(KeyframeId sub_map, KeyframeId into, const geometry::Pose& T_into_sub_map);
  /// Takes what they have seen from the key-frames of a sub-map. They keep their ids and poses.
  void clear(KeyframeId sub_map);

  /// Key-frames that share landmarks with `id`, at most `most`: most shared first, then the newest. Without `id`
  /// itself.
  std::vector<KeyframeId> covisible(KeyframeId id, std::size_t most) const;
  /// Landmarks that any of the key-frames shows, each once, ascending.
  std::vector<LandmarkId> landmarks_of(const std::vector<KeyframeId>& keyframes) const;

 private:
  std::vector<Keyframe> keyframes_;
  std::vector<Landmark> landmarks_;
  std::size_t alive_ = 0;
};

}  // namespace lapis::slam
