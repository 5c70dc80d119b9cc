#include "simulator/core/truth/voxel_truth.hpp"

#include <algorithm>
#include <iterator>
#include <map>
#include <stdexcept>
#include <utility>

#include "simulator/core/truth/explorable.hpp"
#include "simulator/core/truth/mesh_voxels.hpp"

namespace lapis::simulator {
namespace {

/// Hits of an occupied voxel, which are enough for any sensor model [1/256 vote].
constexpr std::uint32_t kHits = 32 * mapping::kOneVote;

/// Map of the known voxels: occupied where there is surface, free elsewhere.
mapping::VoxelMap to_map(const VoxelSet& known, const std::vector<SurfaceVoxel>& surface, const VoxelBox& box) {
  std::map<mapping::BlockIndex, mapping::VoxelBlock> blocks;
  auto next = surface.begin();
  for (const std::size_t cell : known.cells()) {
    const mapping::VoxelIndex voxel = box.index_of(cell);
    mapping::VoxelBlock& block = blocks[mapping::block_of(voxel)];
    while (next != surface.end() && next->cell < cell) ++next;
    if (next != surface.end() && next->cell == cell) {
      block.add_hit(mapping::offset_in_block(voxel), next->label, kHits);
    } else {
      block.add_miss(mapping::offset_in_block(voxel), mapping::kOneVote);
    }
  }
  mapping::VoxelMap map(box.resolution_m());
  for (auto& [index, block] : blocks) map.set_block(index, std::move(block));
  return map;
}

/// Positions of the camera in the world frame [m], one for each square that a disc of this radius can reach.
std::vector<Eigen::Vector3d> eyes(const NavMap& nav_map, const Eigen::Vector3d& start, double radius_m,
                                  const TruthConfig& config) {
  std::vector<Eigen::Vector3d> places;
  for (const auto& p : viewpoints(nav_map, start.head<2>(), radius_m, config.view_spacing_m))
    places.emplace_back(p.x(), p.y(), start.z() + config.mount.height_m);
  return places;
}

/// Those of `places` that are among `others`, or those that are not.
std::vector<Eigen::Vector3d> select(const std::vector<Eigen::Vector3d>& places,
                                    const std::vector<Eigen::Vector3d>& others, bool are_among) {
  std::vector<Eigen::Vector3d> selected;
  std::copy_if(places.begin(), places.end(), std::back_inserter(selected), [&](const Eigen::Vector3d& p) {
    return (std::find(others.begin(), others.end(), p) != others.end()) == are_among;
  });
  return selected;
}

}  // namespace

VoxelTruth make_voxel_truth(const Scene& scene, const SceneRaycaster& raycaster, const NavMap& nav_map,
                            const geometry::Pose& T_world_base, const TruthConfig& config) {
  const geometry::Pose T = T_map_world(T_world_base);
  const Eigen::Vector3d start = T_world_base.translation();
  const auto places = eyes(nav_map, start, config.robot_radius_m, config);
  const auto roomy = eyes(nav_map, start, config.robot_radius_m + config.margin_m, config);
  if (places.empty()) throw std::runtime_error("ground truth: the robot does not fit at its start");
  const VoxelBox box = voxel_box(scene, T, config.resolution_m, places);
  const auto surface = surface_voxels(scene, T, box);
  VoxelSet solid(box);
  for (const auto& voxel : surface) solid.insert(voxel.cell);
  const VisibilityConfig visibility{elevation_range(config.camera, config.mount.pitch_down_rad), config.sensing_range_m,
                                    config.threads, config.cancelled};
  const auto seen_from = [&](const std::vector<Eigen::Vector3d>& from) {
    return visible_voxels(raycaster, from, visibility, T, box);
  };
  // Most places are reached with and without the margin: they are evaluated only once.
  VoxelSet seen = seen_from(select(places, roomy, true)), seen_with_margin = seen;
  seen.insert(seen_from(select(places, roomy, false)));
  seen_with_margin.insert(seen_from(select(roomy, places, false)));
  return {to_map(seen, surface, box), to_map(flooded_voxels(solid, places, T, box), surface, box),
          to_map(seen_with_margin, surface, box)};
}

std::vector<std::uint16_t> most_frequent_classes(const mapping::VoxelMap& mesh, std::size_t count) {
  std::map<std::uint16_t, std::size_t> voxels;
  mesh.for_each_observed([&](const mapping::VoxelIndex&, const mapping::VoxelCounts& counts) {
    if (!counts.hits.empty() && counts.hits.front().label != 0) ++voxels[counts.hits.front().label];
  });
  std::vector<std::pair<std::uint16_t, std::size_t>> sorted(voxels.begin(), voxels.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::uint16_t> classes;
  for (std::size_t i = 0; i < std::min(count, sorted.size()); ++i) classes.push_back(sorted[i].first);
  return classes;
}

}  // namespace lapis::simulator
