#pragma once

#include <string>

#include "slam/core/config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/motion_model.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// Finds the pose of frames that show too few features: by the surfaces of near key-frames (point to plane), starting
/// where motion leads. Directions that the surfaces leave open, such as the path along a corridor, are those of
/// motion, and get no information.
class SurfaceTracker {
 public:
  explicit SurfaceTracker(const SlamConfig& config) : config_(config) {}

  /// @param reference of the frame before; its neighbours, and the newest key-frames, are looked at
  /// @param expected where motion leads, with its covariance
  /// @return as for vision, without matches: T_reference_camera is what the surfaces say in the directions that they
  ///   know, and what was expected in the others; `alignment.information` is zero there. Not tracked, with the reason,
  ///   when too little of the surfaces is seen again, no direction is known, or surfaces and motion contradict each
  ///   other (SurfaceConfig::max_disagreement, or the frame sees through the surfaces)
  TrackOutcome track(const Map& map, const Frame& frame, KeyframeId reference,
                     const MotionModel::Expected& expected) const;

 private:
  struct Candidate {
    KeyframeId id = 0;
    double distance = 0.0;
  };
  std::vector<KeyframeId> near_keyframes(const Map& map, KeyframeId reference,
                                         const geometry::Pose& T_map_camera) const;
  /// What becomes of the samples that are in view. `seen_through`: the frame sees what is behind them, beyond all
  /// doubt about the pose; `differs`: it sees something else, for example what is before them.
  struct Sight {
    int seen = 0, seen_through = 0, differs = 0;
    int in_view() const { return seen + seen_through + differs; }
  };
  /// Whether the walls and furniture that should be in view are not there. Floors and ceilings, which are the same
  /// everywhere, do not count.
  bool is_contradicted(const AlignmentProblem& problem, const geometry::Pose& T_reference_camera,
                       const geometry::Matrix6d& covariance, const Eigen::Vector3d& up_reference) const;
  Sight look(const AlignmentProblem& problem, const geometry::Pose& T_reference_camera,
             const geometry::Matrix6d& covariance) const;

  SlamConfig config_;
};

}  // namespace lapis::slam
