#include "tests/benchmark/planner/half_explored.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>

#include "common/mapping/votes/integration.hpp"
#include "simulator/set_up.hpp"

namespace lapis::planner::test {
namespace {

mapping::CompactFrame compact_frame(const geometry::PinholeCamera& camera, const simulator::CameraImages& images) {
  geometry::DepthImage depth(camera.width, camera.height);
  std::transform(images.depth_mm.pixels.begin(), images.depth_mm.pixels.end(), depth.pixels.begin(),
                 [](std::uint16_t mm) { return 1e-3f * static_cast<float>(mm); });
  std::string error;
  return mapping::CompactFrame::make(camera, depth, &images.labels, {}, error).value();
}

Tour drive() {
  const simulator::SimulatorConfig config = apartment();
  const simulator::World world = simulator::open_world(config);
  const simulator::StartPose start = simulator::start_pose(world, config);
  auto follower = simulator::plan_tour(world, start, config);
  simulator::Simulation simulation(world, simulator::simulation_config(config), start);
  const auto camera = robot::pinhole_camera(config.robot.camera);
  const geometry::Pose T_base_camera = geometry::T_base_camera(robot::camera_mount(config.robot.camera));
  Tour tour;
  std::optional<simulator::DriveCommand> command;
  while (!follower->is_finished()) {
    const simulator::SensorFrame frame = simulation.next(command);
    tour.T_map_camera.emplace_back(frame.T_world_base * T_base_camera);
    tour.frames.push_back(compact_frame(camera, frame.images));
    command = follower->command(frame.robot);
  }
  tour.frames.erase(tour.frames.begin() + static_cast<std::ptrdiff_t>(tour.frames.size() / 2), tour.frames.end());
  return tour;
}

}  // namespace

simulator::SimulatorConfig apartment() {
  simulator::SimulatorConfig config;
  config.scene = "apartment";
  config.tour = "bundled";
  return config;
}

const Tour& tour() {
  static const Tour kTour = drive();
  return kTour;
}

mapping::VoxelMap half_explored_map(double resolution_m) {
  mapping::VoxelMap map(resolution_m);
  for (std::size_t i = 0; i < tour().frames.size(); ++i)
    map.add(compute_votes(tour().frames[i], tour().T_map_camera[i], {}, resolution_m));
  return map;
}

}  // namespace lapis::planner::test
