#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "slam/core/config.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/tracking/matcher.hpp"
#include "slam/core/tracking/pose_refiner.hpp"

namespace lapis::slam {

/// Pose of a frame relative to a key-frame, or the reason why there is none.
struct TrackOutcome {
  bool is_tracked = false;
  std::string reason;            ///< empty when tracked
  bool is_new_view = false;      ///< by surfaces: too little of the view was seen before
  bool is_contradicted = false;  ///< by surfaces: the frame sees through those that should be in view
  KeyframeId reference = 0;
  Alignment alignment;
  std::vector<Match> inliers;
  int matches = 0;  ///< before the refinement
};

/// Finds the pose of frames in the map around a reference key-frame.
class Tracker {
 public:
  explicit Tracker(const SlamConfig& config) : config_(config) {}

  /// Renews the local map around `reference`; call it after every change of the map.
  void set_reference(const Map& map, KeyframeId reference);
  /// Tries, in this order, until one is convincing: projection with the predicted pose, within `radius_px` and in two
  /// wider searches; brute force with the reference key-frame. A pose that `is_expected` is not is the last resort.
  /// Without a prediction nothing is tried: see `recognize`.
  TrackOutcome track(const Map& map, const Frame& frame, const std::optional<geometry::Pose>& predicted,
                     double radius_px, const std::function<bool(const TrackOutcome&)>& is_expected) const;
  /// Root-mean-square distance of the inliers from where `T_map_camera` has them, at the finest pyramid level [px].
  double surprise_px(const Map& map, const Frame& frame, const TrackOutcome& outcome,
                     const geometry::Pose& T_map_camera) const;
  /// Pose of a frame relative to a key-frame anywhere in the map: by brute force or, where the pose is roughly known
  /// (`T_map_camera`), by projection. No other key-frame is tried. It uses features alone: surfaces that are seen from
  /// metres apart are paired with other, parallel ones, an error of centimetres that does not show in the residuals.
  TrackOutcome recognize(const Map& map, const Frame& frame, KeyframeId keyframe,
                         const std::optional<geometry::Pose>& T_map_camera = std::nullopt) const;

 private:
  /// What frames near a key-frame are compared with.
  struct LocalMap {
    KeyframeId reference = 0;
    std::vector<LandmarkId> landmarks;
    std::vector<SurfaceSample> surface;  // in the reference key-frame's optical frame
  };

  /// The key-frame and its most covisible ones.
  std::vector<KeyframeId> nearby(const Map& map, KeyframeId keyframe) const;
  LocalMap local_map(const Map& map, KeyframeId reference) const;
  TrackOutcome track_projected(const Map& map, const Frame& frame, const LocalMap& local,
                               const geometry::Pose& predicted, double radius_px) const;
  /// `gather` is asked for the local map when the key-frame is recognised.
  TrackOutcome track_brute_force(const Map& map, const Frame& frame, KeyframeId keyframe,
                                 const std::function<LocalMap()>& gather) const;
  std::vector<PointConstraint> constraints(const Map& map, const Frame& frame, KeyframeId reference,
                                           const std::vector<Match>& matches) const;
  /// `window_px2`: area in which the pixel of a wrong match can lie [px^2].
  std::string fault_of(const Alignment& alignment, const geometry::PinholeCamera& camera,
                       const std::vector<PointConstraint>& points, double window_px2) const;

  SlamConfig config_;
  LocalMap local_;
};

}  // namespace lapis::slam
