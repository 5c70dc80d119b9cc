#pragma once

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "common/mapping/model/voxel_index.hpp"
#include "planner/core/information/path_information.hpp"

namespace lapis::planner::test {

/// Calls visit(voxel) for each cell of a ray in turn until it says no; textbook form of [Amanatides & Woo 1987].
/// @param start, travel [voxels]
template <class Visit>
void walk_cells(const Eigen::Vector3d& start, const Eigen::Vector3d& travel, Visit&& visit) {
  Eigen::Vector3d next, per_cell;
  Eigen::Vector3i cell = start.array().floor().cast<int>(), step;
  for (int axis = 0; axis < 3; ++axis) {
    step[axis] = travel[axis] < 0.0 ? -1 : 1;
    per_cell[axis] = 1.0 / std::abs(travel[axis]);
    const double to_next = travel[axis] < 0.0 ? start[axis] - cell[axis] : cell[axis] + 1.0 - start[axis];
    next[axis] = to_next * per_cell[axis];
  }
  while (visit(mapping::VoxelIndex{cell[0], cell[1], cell[2]})) {
    Eigen::Index axis = 0;
    if (next.minCoeff(&axis) >= 1.0) return;
    cell[axis] += step[axis];
    next[axis] += per_cell[axis];
  }
}

/// path_information as one would write it down: a table of cells, each looked up and evaluated when a ray comes to it.
/// @param cell_at gives the CellInformation of a VoxelIndex
template <class CellAt>
double plain_path_information(const View& view, const ViewPath& path, double resolution_m, Counting counting,
                              const CellAt& cell_at) {
  struct Seen {
    double gain, reach = 0.0;
  };
  std::unordered_map<mapping::VoxelIndex, Seen, mapping::GridIndexHash> cells;
  for (const geometry::Pose& T_map_camera : path) {
    for (const Eigen::Vector3d& direction : view.directions()) {
      double reach = 1.0;
      const Eigen::Vector3d travel = T_map_camera.linear() * direction * view.config().range_m / resolution_m;
      walk_cells(T_map_camera.translation() / resolution_m, travel, [&](const mapping::VoxelIndex& voxel) {
        const CellInformation cell = cell_at(voxel);
        Seen& seen = cells.try_emplace(voxel, Seen{cell.gain}).first->second;
        seen.reach = counting == Counting::kOnce ? std::max(seen.reach, reach) : seen.reach + reach;
        reach *= cell.free;
        return reach >= view.config().min_reach;
      });
    }
  }
  double sum = 0.0;
  for (const auto& [voxel, seen] : cells) sum += seen.gain * seen.reach;
  return sum;
}

}  // namespace lapis::planner::test
