#include "simulator/core/truth/voxel_truth.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "simulator/core/truth/explorable.hpp"
#include "simulator/core/truth/mesh_voxels.hpp"

namespace lapis::simulator {
namespace {

/// As many hits as leave no doubt whatever the sensor model [1/256 vote].
constexpr std::uint32_t kHits = 32 * mapping::kOneVote;

/// Occupied where there is surface, free elsewhere.
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

}  // namespace

VoxelTruth make_voxel_truth(const Scene& scene, const SceneRaycaster& raycaster, const NavMap& nav_map,
                            const geometry::Pose& T_world_base, const TruthConfig& config) {
  const geometry::Pose T = T_map_world(T_world_base);
  const Eigen::Vector3d start = T_world_base.translation();
  std::vector<Eigen::Vector3d> eyes;
  for (const auto& p : viewpoints(nav_map, start.head<2>(), config.robot_radius_m, config.view_spacing_m)) {
    eyes.emplace_back(p.x(), p.y(), start.z() + config.mount.height_m);
  }
  const VoxelBox box = voxel_box(scene, T, config.resolution_m, eyes);
  const auto surface = surface_voxels(scene, T, box);
  VoxelSet solid(box);
  for (const auto& voxel : surface) solid.insert(voxel.cell);
  const VisibilityConfig visibility{elevation_range(config.camera, config.mount.pitch_down_rad), config.sensing_range_m,
                                    config.threads, config.cancelled};
  const VoxelSet seen = visible_voxels(raycaster, eyes, visibility, T, box);
  return {to_map(seen, surface, box), to_map(flooded_voxels(solid, eyes, T, box), surface, box)};
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
