#include "tests/benchmark/planner/exploration/parts.hpp"

#include <ctime>
#include <stdexcept>

#include "simulator/core/truth/voxel_truth.hpp"

namespace lapis::planner::benchmark {

double cpu_s() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

geometry::Pose planar(const Eigen::Vector2d& position, double yaw_rad, double z_m) {
  return geometry::make_pose({position.x(), position.y(), z_m},
                             Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())));
}

simulator::RobotState at_rest(const simulator::StartPose& start) {
  simulator::RobotState state;
  state.position = start.position;
  state.yaw_rad = start.yaw_rad;
  return state;
}

ObstacleGrid to_obstacles(const semantic_mapper::OccupancyGrid& grid) {
  return {{grid.origin_x_m, grid.origin_y_m}, grid.resolution_m, grid.width, grid.height, grid.cells};
}

Explorable::Explorable(const simulator::World& world, const geometry::Pose& T_world_map,
                       const robot::RobotDescription& robot) {
  simulator::TruthConfig config;
  config.sensing_range_m = robot.sensing_range_m;
  config.robot_radius_m = robot.radius_m;
  config.camera = robot::pinhole_camera(robot.camera);
  config.mount = robot::camera_mount(robot.camera);
  const auto truth = make_voxel_truth(world.scene(), world.raycaster(), world.nav_map(), T_world_map, config).mesh;
  truth.for_each_observed(
      [&](const mapping::VoxelIndex& voxel, const mapping::VoxelCounts&) { voxels_.push_back(voxel); });
  if (voxels_.empty()) throw std::runtime_error("nothing can be explored from the start");
}

double Explorable::share_known(const mapping::VoxelMap& map) const {
  std::size_t known = 0;
  for (const mapping::VoxelIndex& voxel : voxels_) known += map.read(voxel).is_observed() ? 1 : 0;
  return static_cast<double>(known) / static_cast<double>(voxels_.size());
}

}  // namespace lapis::planner::benchmark
