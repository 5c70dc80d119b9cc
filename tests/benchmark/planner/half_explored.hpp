#pragma once

#include <vector>

#include "common/geometry/se3.hpp"
#include "common/mapping/model/voxel_map.hpp"
#include "common/mapping/votes/compact_frame.hpp"
#include "simulator/simulator_config.hpp"

namespace lapis::planner::test {

/// True poses of the camera on the bundled tour of the apartment, and what it saw in the first half.
struct Tour {
  std::vector<geometry::Pose> T_map_camera;
  std::vector<mapping::CompactFrame> frames;
};

simulator::SimulatorConfig apartment();
/// Driven at the first call.
const Tour& tour();
/// What the frames make of an empty map.
mapping::VoxelMap half_explored_map(double resolution_m);

}  // namespace lapis::planner::test
