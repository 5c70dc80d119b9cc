#include "tests/benchmark/slam/lost_trial.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "simulator/core/robot/starts.hpp"
#include "simulator/core/robot/tour_follower.hpp"
#include "slam/core/graph/pose_graph.hpp"
#include "slam/core/motion/covariance.hpp"
#include "tests/benchmark/slam/dice.hpp"
#include "tests/benchmark/slam/tour_recording.hpp"
#include "tests/benchmark/slam/trial_rig.hpp"

namespace lapis::slam::benchmark {
namespace {

using geometry::Pose;
using simulator::DriveCommand;
using simulator::RobotState;
using simulator::StartPose;

StartPose draw_place(const simulator::World& world, double radius_m, Dice& dice) {
  constexpr double kRoom_m = 0.3;  // the robot drives a little while it turns
  const auto cells = simulator::open_cells(world.nav_map(), radius_m + kRoom_m);
  if (cells.empty()) throw std::runtime_error("scene " + world.scene().name + " has no room to turn in");
  const auto index = static_cast<std::size_t>(dice.between(0.0, static_cast<double>(cells.size())));
  return {world.nav_map().grid().center(cells[index]), dice.between(-std::numbers::pi, std::numbers::pi)};
}

std::function<bool(const RobotState&)> over_after(double end_s) {
  return [end_s](const RobotState& robot) { return robot.stamp.seconds() >= end_s; };
}

}  // namespace

TrialPlan covered_plan(const simulator::World& world, double radius_m, std::uint64_t seed, bool turns_back) {
  constexpr double kCovered_s = 5.0, kAfter_s = 2.5;
  Dice dice(seed);
  TrialPlan plan;
  plan.start = draw_place(world, radius_m, dice);
  const DriveCommand drive{dice.between(-0.12, 0.12), dice.sign() * dice.between(0.3, 0.7)};
  plan.cover_from_s = dice.between(3.0, 4.0);
  plan.cover_to_s = plan.cover_from_s + kCovered_s;
  plan.with_flat_cover = dice.sign() > 0.0;
  const double back_from_s = turns_back ? plan.cover_from_s + 0.5 * kCovered_s : plan.cover_to_s + 2.0 * kAfter_s;
  plan.command = [drive, back_from_s](const RobotState& robot) {
    const double sign = robot.stamp.seconds() < back_from_s ? 1.0 : -1.0;
    return DriveCommand{sign * drive.speed_m_s, sign * drive.turn_rate_rad_s};
  };
  plan.is_over = over_after(plan.cover_to_s + kAfter_s);
  return plan;
}

TrialPlan spin_plan(const simulator::World& world, double radius_m, std::uint64_t seed) {
  constexpr double kSlow_s = 3.0, kAfter_s = 3.0, kBrake_s = 1.0;
  Dice dice(seed);
  TrialPlan plan;
  plan.start = draw_place(world, radius_m, dice);
  const double sign = dice.sign(), slow = sign * dice.between(0.3, 0.6), fast = sign * dice.between(3.0, 6.0);
  const double braked_s = kSlow_s + 2.0 * std::numbers::pi / std::abs(fast);
  plan.command = [=](const RobotState& robot) {
    const double t_s = robot.stamp.seconds();
    if (t_s < kSlow_s) return DriveCommand{0.0, slow};
    if (t_s < braked_s) return DriveCommand{0.0, fast};
    return DriveCommand{0.0, t_s < braked_s + kBrake_s ? 0.0 : -slow};
  };
  plan.is_over = over_after(braked_s + kBrake_s + kAfter_s);
  return plan;
}

TrialPlan corridor_plan(const simulator::World& world, const simulator::TourConfig& tour, std::uint64_t seed) {
  constexpr double kMiddle_m = 0.8;  // y of door and corridor
  Dice dice(seed);
  TrialPlan plan;
  plan.start = {{dice.between(-1.5, -0.9), kMiddle_m}, std::numbers::pi * dice.sign() + dice.between(-0.3, 0.3)};
  const Eigen::Vector2d deep(dice.between(2.5, 6.0), kMiddle_m + dice.between(-0.3, 0.3));
  const Eigen::Vector2d end(-1.5, kMiddle_m);
  const auto follower = std::make_shared<simulator::TourFollower>(
      world.nav_map(), simulator::plan_tour(world.nav_map(), plan.start.position, {deep, end}, tour), tour);
  plan.command = [follower](const RobotState& robot) { return follower->command(robot); };
  plan.is_over = [follower](const RobotState& robot) {
    if (const auto problem = follower->stalled(); !problem.empty()) throw std::runtime_error(problem);
    return follower->is_finished() || robot.stamp.seconds() > 120.0;
  };
  return plan;
}

std::vector<TrialStep> drive_trial(const simulator::World& world, const simulator::SimulationConfig& simulation,
                                   const SlamConfig& config, const TrialPlan& plan, bool with_odometry) {
  const Pose T_base_camera = geometry::T_base_camera(simulation.mount);
  const FeatureExtractor extractor(config.features);
  RgbdSlam slam(config, T_base_camera, T_base_camera);
  TrialRig rig(world, simulation, plan.start);
  std::vector<TrialStep> steps;
  Pose T_odom_base = Pose::Identity();
  while (!plan.is_over(rig.robot())) {
    for (const auto& reading : rig.advance(plan.command(rig.robot()))) {
      T_odom_base = pose_of(reading);
      if (with_odometry) slam.add_odometry(reading.stamp, T_odom_base);
    }
    TrialStep step;
    step.t_s = rig.robot().stamp.seconds();
    step.is_covered = step.t_s >= plan.cover_from_s && step.t_s < plan.cover_to_s;
    const RgbdFrame frame = step.is_covered ? rig.see_cover(plan.with_flat_cover) : rig.see();
    const TrackingResult result = slam.process(frame);
    if (!step.is_covered) {
      const int usable = make_frame(frame, extractor, config.noise).features_with_depth;
      step.is_usable = usable >= config.tracker.min_matches;
    }
    step.state = result.state;
    step.has_pose = has_pose(result);
    step.is_keyframe = result.is_keyframe;
    step.estimate = result.T_map_keyframe * result.T_keyframe_camera;
    step.truth = rig.T_world_camera();
    step.odometry = T_odom_base * T_base_camera;
    step.graph_version = slam.graph_version();
    step.keyframes = slam.keyframe_count();
    step.landmarks = slam.landmark_count();
    step.matches = result.matches;
    step.inliers = result.inliers;
    step.sigma_m = largest_sigma(result.covariance, 0);
    step.reason = result.reason;
    steps.push_back(std::move(step));
  }
  return steps;
}

}  // namespace lapis::slam::benchmark
