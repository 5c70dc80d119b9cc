#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "planner/core/space/pose_path.hpp"
#include "tests/unit/planner/hallucination/small_world.hpp"

namespace lapis::planner::test {

/// What a slam without errors would know of a robot's path: key-frames in a chain, and landmarks all over the place, of
/// which a key-frame shows those in front of it.
class WalkSlam {
 public:
  struct Knowledge {
    AnalysedGraph graph;
    LandmarkIndex landmarks;
  };

  /// A key-frame, when the robot has moved or turned so far.
  void track(const Pose2& robot) {
    const bool is_new = poses_.empty() || (poses_.back().p_map - robot.p_map).norm() > kStep_m ||
                        turn_between(poses_.back().yaw_rad, robot.yaw_rad) > kTurn_rad;
    if (is_new) poses_.push_back(robot);
  }
  /// As after a loop closure.
  void move(const Eigen::Vector2d& by) {
    for (Pose2& pose : poses_) pose.p_map += by;
  }
  /// Nothing while there is no edge.
  std::optional<Knowledge> knowledge(double resolution_m) const {
    if (poses_.size() < 2) return std::nullopt;
    std::vector<geometry::Pose> cameras;
    for (const Pose2& pose : poses_) cameras.push_back(camera_at(pose.p_map.x(), pose.p_map.y(), pose.yaw_rad));
    AnalysedGraph graph = Chain(cameras).graph();
    LandmarkIndex landmarks({{mapping::TileIndex{}, tile()}}, graph, resolution_m);
    return Knowledge{std::move(graph), std::move(landmarks)};
  }

 private:
  static constexpr double kStep_m = 0.5, kTurn_rad = 0.5, kRange_m = 3.0, kHalfView_rad = 0.6;
  static constexpr int kLandmarks = 50;  // around each corner of a grid of a metre

  mapping::LandmarkTile tile() const {
    mapping::LandmarkTile tile;
    for (const auto& [corner, observers] : observers_of_corners()) {
      for (int i = 0; i < kLandmarks; ++i) {
        tile.ids.push_back(static_cast<std::uint32_t>(tile.ids.size()));
        tile.positions_m.emplace_back(static_cast<float>(corner.first), static_cast<float>(corner.second),
                                      0.5f + 0.02f * static_cast<float>(i));
        tile.observers.insert(tile.observers.end(), observers.begin(), observers.end());
        tile.observer_ends.push_back(static_cast<std::uint32_t>(tile.observers.size()));
      }
    }
    return tile;
  }
  std::map<std::pair<int, int>, std::vector<std::uint32_t>> observers_of_corners() const {
    std::map<std::pair<int, int>, std::vector<std::uint32_t>> observers;
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      const auto around = [](double center) {
        return std::pair(static_cast<int>(std::ceil(center - kRange_m)),
                         static_cast<int>(std::floor(center + kRange_m)));
      };
      const auto [x_begin, x_end] = around(poses_[i].p_map.x());
      const auto [y_begin, y_end] = around(poses_[i].p_map.y());
      for (int x = x_begin; x <= x_end; ++x) {
        for (int y = y_begin; y <= y_end; ++y) {
          if (shows(poses_[i], {x, y})) observers[{x, y}].push_back(static_cast<std::uint32_t>(10 + i));
        }
      }
    }
    return observers;
  }
  static bool shows(const Pose2& pose, const Eigen::Vector2d& corner) {
    const Eigen::Vector2d to = corner - pose.p_map;
    return to.norm() > 0.3 && to.norm() < kRange_m &&
           turn_between(std::atan2(to.y(), to.x()), pose.yaw_rad) < kHalfView_rad;
  }

  std::vector<Pose2> poses_;
};

}  // namespace lapis::planner::test
