#include "semantic_mapper/core/map_merge.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace lapis::semantic_mapper {
namespace {

using mapping::BlockIndex;
using mapping::kBlockEdge;
using mapping::VoxelBlock;
using mapping::VoxelCounts;
using mapping::VoxelIndex;

constexpr double kOnGridTolerance = 1e-6;

/// The voxel that contains a point, whose coordinates are in voxels.
VoxelIndex voxel_of(const Eigen::Vector3d& p_voxels) {
  const auto cell = [](double x) { return static_cast<std::int32_t>(std::floor(x)); };
  return {cell(p_voxels.x()), cell(p_voxels.y()), cell(p_voxels.z())};
}

Eigen::Vector3d center(const VoxelIndex& v) { return Eigen::Vector3d(v.x + 0.5, v.y + 0.5, v.z + 0.5); }

std::uint32_t checked_sum(std::uint32_t a, std::uint32_t b) {
  if (b > std::numeric_limits<std::uint32_t>::max() - a)
    throw std::runtime_error("more votes in a voxel than 32 bits hold; merge fewer maps");
  return a + b;
}

/// Blocks that the other map reaches, as they are in the sum.
class Sum {
 public:
  explicit Sum(const mapping::VoxelMap& map) : map_(map) {}

  void add(const VoxelIndex& voxel, const VoxelCounts& counts) {
    VoxelBlock& block = block_at(mapping::block_of(voxel));
    const int offset = mapping::offset_in_block(voxel);
    block.read(offset, before_);
    checked_sum(before_.misses, counts.misses);
    for (const mapping::ClassCount& hit : counts.hits)
      for (const mapping::ClassCount& old : before_.hits)
        if (old.label == hit.label) checked_sum(old.count, hit.count);
    block.add_miss(offset, counts.misses);
    for (const mapping::ClassCount& hit : counts.hits) block.add_hit(offset, hit.label, hit.count);
  }
  std::map<BlockIndex, VoxelBlock> take() { return std::move(blocks_); }

 private:
  VoxelBlock& block_at(const BlockIndex& index) {
    const auto [it, is_new] = blocks_.try_emplace(index);
    const VoxelBlock* old = is_new ? map_.find(index) : nullptr;
    if (old != nullptr) it->second = *old;
    return it->second;
  }

  const mapping::VoxelMap& map_;
  std::map<BlockIndex, VoxelBlock> blocks_;
  VoxelCounts before_;
};

/// Calls visit(voxel) for all voxels that a block may reach when T moves it. The translation of T is in voxels.
template <class Visitor>
void for_each_reached(const BlockIndex& index, const geometry::Pose& T, Visitor&& visit) {
  const VoxelIndex first = mapping::voxel_at(index, 0);
  const Eigen::Vector3d middle = T * Eigen::Vector3d(first.x + 4.0, first.y + 4.0, first.z + 4.0);
  const Eigen::Vector3d reach = T.linear().cwiseAbs() * Eigen::Vector3d::Constant(0.5 * kBlockEdge);
  const VoxelIndex low = voxel_of(middle - reach), high = voxel_of(middle + reach);
  for (std::int32_t z = low.z; z <= high.z; ++z)
    for (std::int32_t y = low.y; y <= high.y; ++y)
      for (std::int32_t x = low.x; x <= high.x; ++x) visit(VoxelIndex{x, y, z});
}

std::map<BlockIndex, VoxelBlock> summed_blocks(const mapping::VoxelMap& map, const mapping::VoxelMap& other,
                                               const geometry::Pose& T_map_other) {
  geometry::Pose T = T_map_other;
  T.translation() /= map.resolution_m();
  const geometry::Pose T_back = T.inverse();
  Sum sum(map);
  VoxelCounts counts;
  for (const BlockIndex& index : other.sorted_blocks()) {
    const VoxelBlock& block = *other.find(index);
    for_each_reached(index, T, [&](const VoxelIndex& voxel) {
      const VoxelIndex source = voxel_of(T_back * center(voxel));
      if (mapping::block_of(source) != index) return;
      block.read(mapping::offset_in_block(source), counts);
      if (counts.is_observed()) sum.add(voxel, counts);
    });
  }
  return sum.take();
}

mapping::SensorModel with_classes_of(mapping::SensorModel model, const mapping::SensorModel& other) {
  if (model.class_priors != other.class_priors)
    throw std::runtime_error("the sensor model has other prior shares of the classes than the maps before");
  if ((model.fusion == "bki") != (other.fusion == "bki"))
    throw std::runtime_error("fused by " + other.fusion + ", the maps before by " + model.fusion +
                             ": votes that a kernel has smoothed and whole ones do not add up");
  model.class_count = std::max(model.class_count, other.class_count);
  return model;
}

}  // namespace

bool is_on_grid(const geometry::Pose& T, double resolution_m) {
  const Eigen::Matrix3d R = T.linear();
  const Eigen::Vector3d t = T.translation() / resolution_m;
  return (R - R.array().round().matrix()).cwiseAbs().maxCoeff() <= kOnGridTolerance &&
         (t - t.array().round().matrix()).cwiseAbs().maxCoeff() <= kOnGridTolerance;
}

void merge_into(mapping::MapFile& sum, const mapping::MapFile& other, const geometry::Pose& T_map_other) {
  if (sum.map.resolution_m() != other.map.resolution_m())
    throw std::runtime_error("voxels of " + std::to_string(other.map.resolution_m()) + " m, the maps before have " +
                             std::to_string(sum.map.resolution_m()) + " m; build all maps at one resolution");
  auto labels = mapping::LabelList::united(sum.labels, other.labels);
  auto model = with_classes_of(sum.sensor_model, other.sensor_model);
  auto blocks = summed_blocks(sum.map, other.map, T_map_other);
  sum.labels = std::move(labels);
  sum.sensor_model = std::move(model);
  if (sum.frames != other.frames) sum.frames.reset();
  for (auto& [index, block] : blocks) sum.map.set_block(index, std::move(block));
}

}  // namespace lapis::semantic_mapper
