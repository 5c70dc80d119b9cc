#pragma once

#include <vector>

#include <Eigen/Core>

#include "common/geometry/se3.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "common/robot/robot_description.hpp"
#include "planner/core/space/planning_grid.hpp"
#include "semantic_mapper/core/occupancy_grid.hpp"
#include "simulator/core/robot/robot.hpp"
#include "simulator/core/world.hpp"
#include "simulator/set_up.hpp"

namespace lapis::planner::benchmark {

/// CPU time of this thread [s].
double cpu_s();
/// Pose on a floor at height z.
geometry::Pose planar(const Eigen::Vector2d& position, double yaw_rad, double z_m);
simulator::RobotState at_rest(const simulator::StartPose& start);
ObstacleGrid to_obstacles(const semantic_mapper::OccupancyGrid& grid);

/// Voxels that can be known, and how many of them are.
class Explorable {
 public:
  /// @throws std::runtime_error when nothing can be explored from the start
  Explorable(const simulator::World& world, const geometry::Pose& T_world_map, const robot::RobotDescription& robot);
  double share_known(const mapping::VoxelMap& map) const;

 private:
  std::vector<mapping::VoxelIndex> voxels_;
};

}  // namespace lapis::planner::benchmark
