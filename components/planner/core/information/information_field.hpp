#pragma once

#include <array>
#include <map>
#include <memory>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/mapping/model/voxel_map.hpp"
#include "planner/core/information/cell_information.hpp"

namespace lapis::planner {

/// What rays have to know about the cells of a map: two numbers per voxel, renewed where the map changed. Blocks that
/// the map does not have are unknown, but for where a surface beside them goes on. Blocks whose cells are all equal
/// share one copy.
template <class Real>
class BasicInformationField {
 public:
  struct Block {
    std::array<Real, mapping::kBlockVoxels> free;  ///< CellInformation::free by offset_in_block
    std::array<Real, mapping::kBlockVoxels> gain;  ///< CellInformation::gain [nats]
  };

  /// Of an empty map with voxels of this edge. Throws std::runtime_error naming the parameter that is out of range.
  BasicInformationField(double resolution_m, const mapping::SensorModel& model, const RayModel& ray);

  double resolution_m() const { return resolution_m_; }

  /// Reads blocks of the map again, in parallel; those that it does not have become unknown. Also their neighbours,
  /// where surfaces go on. Throws std::invalid_argument when the map's resolution is another.
  void update(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed);
  /// Reads the whole map.
  void rebuild(const mapping::VoxelMap& map);
  /// Replaces what is known about a block, by offset_in_block.
  void set_block(const mapping::BlockIndex& index, std::span<const CellInformation, mapping::kBlockVoxels> cells);

  const Block& block(const mapping::BlockIndex& index) const;
  CellInformation cell(const mapping::VoxelIndex& voxel) const;

 private:
  using BlockPtr = std::shared_ptr<const Block>;

  std::vector<mapping::BlockIndex> with_neighbours(std::span<const mapping::BlockIndex> changed) const;
  std::shared_ptr<Block> make_block(const mapping::VoxelBlock& voxels) const;
  void continue_surfaces(const mapping::VoxelMap& map, const mapping::BlockIndex& index,
                         const mapping::VoxelBlock& voxels, Block& block) const;
  /// The shared copy, when all cells of the block are equal.
  BlockPtr share_if_uniform(BlockPtr block);

  double resolution_m_;
  CellMeasure measure_;
  std::unordered_map<mapping::BlockIndex, BlockPtr, mapping::GridIndexHash> blocks_;
  std::map<std::pair<Real, Real>, BlockPtr> uniform_;  ///< by free and gain
  BlockPtr unknown_;
};

using InformationField = BasicInformationField<float>;

extern template class BasicInformationField<float>;
extern template class BasicInformationField<double>;

}  // namespace lapis::planner
