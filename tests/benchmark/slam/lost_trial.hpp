#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/geometry/se3.hpp"
#include "simulator/core/robot/tour.hpp"
#include "simulator/core/simulation.hpp"
#include "slam/core/rgbd_slam.hpp"

namespace lapis::slam::benchmark {

/// What drives the robot and covers its camera in one trial.
struct TrialPlan {
  simulator::StartPose start;
  std::function<simulator::DriveCommand(const simulator::RobotState&)> command;
  std::function<bool(const simulator::RobotState&)> is_over;
  double cover_from_s = 0.0;     ///< stamps at which something is in front of the camera: from (included) ...
  double cover_to_s = 0.0;       ///< ... to (not included)
  bool with_flat_cover = false;  ///< the cover is grey and has depth; else the images are black and without depth
};

/// One frame of a trial.
struct TrialStep {
  double t_s = 0.0;
  bool is_covered = false;
  bool is_usable = false;  ///< not covered, and as many features with depth as slam needs to begin a map
  TrackingState state = TrackingState::kInitializing;
  bool has_pose = false;
  bool is_keyframe = false;
  geometry::Pose estimate = geometry::Pose::Identity();  ///< T_map_camera as published; valid when has_pose
  geometry::Pose truth = geometry::Pose::Identity();     ///< T_world_camera
  geometry::Pose odometry = geometry::Pose::Identity();  ///< T_odom_camera by odometry alone
  std::uint64_t graph_version = 0;
  std::size_t keyframes = 0;
  std::size_t landmarks = 0;
  std::uint32_t matches = 0, inliers = 0;
  double sigma_m = 0.0;  ///< of the position relative to its key-frame, along the direction that is least known
  std::string reason;
};

/// A stop for `cover_s` in the middle of turning, at a place of the map with room around it. The camera continues
/// turning, or turns back halfway so that it returns to what it saw (`turns_back`).
TrialPlan covered_plan(const simulator::World& world, double radius_m, std::uint64_t seed, bool turns_back);
/// Slowly, then once around much too fast, then slowly back over what was seen.
TrialPlan spin_plan(const simulator::World& world, double radius_m, std::uint64_t seed);
/// From the office of the scene blank_corridor into its corridor, and back.
TrialPlan corridor_plan(const simulator::World& world, const simulator::TourConfig& tour, std::uint64_t seed);

/// Drives the plan. Frames that are covered are not rendered.
std::vector<TrialStep> drive_trial(const simulator::World& world, const simulator::SimulationConfig& simulation,
                                   const SlamConfig& config, const TrialPlan& plan, bool with_odometry);

}  // namespace lapis::slam::benchmark
