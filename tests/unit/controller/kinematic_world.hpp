#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "common/geometry/camera_mount.hpp"
#include "controller/core/controller.hpp"
#include "tests/support/synthetic_room.hpp"

namespace lapis::controller {

using lapis::test::Box;

/// A robot with a depth camera among boxes, driven by the controller at 15 Hz as in lock-step: a command computed from
/// frame k acts from frame k + 1 on. Drives follow with a lag; the robot does not move into boxes.
class KinematicWorld {
 public:
  static constexpr double kRate_hz = 15.0;
  static constexpr double kLag_s = 0.15;
  static constexpr std::uint16_t kGlass = 99;  ///< label of boxes that the camera does not see

  explicit KinematicWorld(std::vector<Box> boxes, const ControllerConfig& config = {})
      : boxes_(std::move(boxes)), controller(config, limits) {}

  /// One frame, one command.
  Decision step() {
    drive();
    now = now + time::Duration::from_seconds(1.0 / kRate_hz);
    if (has_camera) controller.note_camera(now, now);
    if (has_planner) controller.note_planner(now);
    frames_.push_back({T_published_map * T_map_base, {image(), camera, T_base_camera()}, now});
    if (frames_.size() > late_frames) {
      const Frame& frame = frames_.front();
      if (has_pose) controller.set_pose(frame.T_map_base, frame.stamp, now);
      if (has_pose) controller.see(frame.view, frame.stamp, now);
      frames_.pop_front();
    }
    if (has_map) controller.set_obstacles(grid(), now, now);
    Decision decision = controller.step(now);
    acting_ = commanded_;
    commanded_ = decision.command;
    return decision;
  }
  /// Steps until that holds; the seconds it took, or infinity.
  double run_until(const std::function<bool(const Decision&)>& is_over, double limit_s) {
    for (int i = 1; i <= limit_s * kRate_hz; ++i) {
      last = step();
      least_room_m = std::min(least_room_m, room_m(T_map_base.translation()));
      if (is_over(last)) return i / kRate_hz;
    }
    return std::numeric_limits<double>::infinity();
  }
  double run_until(State state, double limit_s) {
    return run_until([state](const Decision& decision) { return decision.state == state; }, limit_s);
  }
  void add(const Box& box) { boxes_.push_back(box); }
  void remove_last() { boxes_.pop_back(); }
  /// Between the robot's disc and the nearest box [m]; 0: they touch.
  double room_m(const Eigen::Vector2d& p) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Box& box : boxes_) {
      if (box.high.z() <= 0.05 || box.low.z() >= 1.2) continue;
      const Eigen::Vector2d low = box.low.head<2>(), high = box.high.head<2>();
      nearest = std::min(nearest, (p - p.cwiseMax(low).cwiseMin(high)).norm());
    }
    return std::max(0.0, nearest - limits.radius_m);
  }

  RobotLimits limits;
  geometry::PinholeCamera camera{160, 90, 80, 80, 79.5, 44.5};
  PlanarPose T_map_base = PlanarPose::Identity();
  PlanarPose T_published_map = PlanarPose::Identity();  ///< error of the poses that slam publishes
  std::size_t late_frames = 0;  ///< so late come pose and depth image; the camera's stamp does not
  Velocity velocity;            ///< of the drives
  time::Time now{1'000'000'000};
  bool has_camera = true, has_pose = true, has_map = true, has_planner = true;
  bool knows_floor = false;  ///< the mapper's grid says that all but boxes is free; else it knows nothing
  Decision last;
  double least_room_m = std::numeric_limits<double>::infinity();

 private:
  struct Frame {
    PlanarPose T_map_base;
    DepthView view;
    time::Time stamp;
  };

  static geometry::Pose T_base_camera() { return geometry::T_base_camera({1.0, 0.0}); }
  geometry::DepthImage image() const {
    std::vector<Box> visible{{{-20, -20, -0.3}, {20, 20, 0}, 2}};
    std::copy_if(boxes_.begin(), boxes_.end(), std::back_inserter(visible),
                 [](const Box& box) { return box.label != kGlass; });
    const Eigen::Vector2d& p = T_map_base.translation();
    const auto T_map_camera =
        geometry::make_pose({p.x(), p.y(), 0.0},
                            Eigen::Quaterniond(Eigen::AngleAxisd(yaw_of(T_map_base), Eigen::Vector3d::UnitZ()))) *
        T_base_camera();
    return lapis::test::render(visible, camera, T_map_camera).depth;
  }
  Grid grid() const {
    constexpr double kCell_m = 0.25, kHalf_m = 10.0;
    Grid g{kCell_m, {-kHalf_m, -kHalf_m}, 80, 80, {}};
    for (int row = 0; row < g.height; ++row) {
      for (int column = 0; column < g.width; ++column) {
        const Eigen::Vector2d center = g.origin + kCell_m * Eigen::Vector2d(column + 0.5, row + 0.5);
        g.cells.push_back(knows_floor && room_m(center) > 0.0 ? std::int8_t{0} : Grid::kUnknown);
      }
    }
    return g;
  }
  void drive() {
    constexpr int kSteps = 10;
    const double h = 1.0 / (kRate_hz * kSteps);
    const auto approach = [h](double& value, double target, double limit) {
      value += std::clamp((target - value) / kLag_s, -limit, limit) * h;
    };
    for (int i = 0; i < kSteps; ++i) {
      approach(velocity.forward_m_s, acting_.forward_m_s, limits.max_acceleration_m_s2);
      approach(velocity.turn_rad_s, acting_.turn_rad_s, limits.max_turn_acceleration_rad_s2);
      const PlanarPose T = T_map_base * planar_pose({velocity.forward_m_s * h, 0.0}, velocity.turn_rad_s * h);
      const bool is_blocked = room_m(T.translation()) == 0.0;
      if (!is_blocked) {
        T_map_base = T;
      } else {
        T_map_base.linear() = T.linear();
        least_room_m = 0.0;
      }
    }
  }

  std::vector<Box> boxes_;
  Velocity commanded_, acting_;
  std::deque<Frame> frames_;

 public:
  Controller controller;  ///< uses the limits
};

}  // namespace lapis::controller
