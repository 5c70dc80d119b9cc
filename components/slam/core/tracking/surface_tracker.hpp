#pragma once

#include <string>

#include "slam/core/config.hpp"
#include "slam/core/frame/frame.hpp"
#include "slam/core/map/map.hpp"
#include "slam/core/motion/motion_model.hpp"
#include "slam/core/tracking/tracker.hpp"

namespace lapis::slam {

/// Finds the pose of frames that show too few features: by the surfaces of near key-frames (point to plane), starting
/// at the pose that motion predicts. Directions that the surfaces leave open, such as the path along a corridor, keep
/// the prediction and get no information.
class SurfaceTracker {
 public:
  explicit SurfaceTracker(const SlamConfig& config) : config_(config) {}

  /// @param reference that of the previous frame; its covisible key-frames and the newest ones are considered
  /// @param expected pose that motion predicts, with its covariance
  /// @return as for vision, without matches: T_reference_camera follows the surfaces in the directions that they
  ///   determine, and the prediction in the others, where `alignment.information` is zero. Not tracked, with the
  ///   reason, when too little of the surfaces is seen again, no direction is determined, or surfaces and motion
  ///   contradict each other (SurfaceConfig::max_disagreement, or the frame sees through the surfaces)
  TrackOutcome track(const Map& map, const Frame& frame, KeyframeId reference,
                     const MotionModel::Expected& expected) const;

 private:
  struct Candidate {
    KeyframeId id = 0;
    double distance = 0.0;
  };
  std::vector<KeyframeId> near_keyframes(const Map& map, KeyframeId reference,
                                         const geometry::Pose& T_map_camera) const;
  /// What the frame shows of the samples that are in view. `seen_through`: it sees what is behind them, by more than
  /// the uncertainty of the pose explains; `differs`: it sees something else, for example something in front of them.
  struct Sight {
    int seen = 0, seen_through = 0, differs = 0;
    int in_view() const { return seen + seen_through + differs; }
  };
  /// Whether walls and furniture that should be in view are missing. Floors and ceilings do not count, because they are
  /// the same everywhere.
  bool is_contradicted(const AlignmentProblem& problem, const geometry::Pose& T_reference_camera,
                       const geometry::Matrix6d& covariance, const Eigen::Vector3d& up_reference) const;
  Sight look(const AlignmentProblem& problem, const geometry::Pose& T_reference_camera,
             const geometry::Matrix6d& covariance) const;

  SlamConfig config_;
};

}  // namespace lapis::slam
