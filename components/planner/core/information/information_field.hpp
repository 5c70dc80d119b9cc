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

/// What rays need to know about the cells of a map: two numbers per voxel, updated where the map changed. Blocks that
/// the map does not have are unknown, except where a surface of a neighbouring block continues. Blocks whose cells are
/// all equal share one copy.
template <class Real>
class BasicInformationField {
 public:
  struct Block {
    std::array<Real, mapping::kBlockVoxels> free;  ///< CellInformation::free by offset_in_block
    std::array<Real, mapping::kBlockVoxels> gain;  ///< CellInformation::gain [nats]
  };

  /// The field of an empty map with voxels of edge `resolution_m`. Throws std::runtime_error naming the parameter that
  /// is out of range.
  BasicInformationField(double resolution_m, const mapping::SensorModel& model, const RayModel& ray);

  double resolution_m() const { return resolution_m_; }

  /// Reads the changed blocks of the map again, in parallel, and their neighbours where surfaces continue; blocks that
  /// the map no longer has become unknown. Throws std::invalid_argument when the map has another resolution.
  void update(const mapping::VoxelMap& map, std::span<const mapping::BlockIndex> changed);
  /// Clears the field and reads the whole map.
  void rebuild(const mapping::VoxelMap& map);
  /// Replaces the cells of a block, which are indexed by offset_in_block.
  void set_block(const mapping::BlockIndex& index, std::span<const CellInformation, mapping::kBlockVoxels> cells);

  const Block& block(const mapping::BlockIndex& index) const;
  CellInformation cell(const mapping::VoxelIndex& voxel) const;

 private:
  using BlockPtr = std::shared_ptr<const Block>;

  std::vector<mapping::BlockIndex> with_neighbours(std::span<const mapping::BlockIndex> changed) const;
  std::shared_ptr<Block> make_block(const mapping::VoxelBlock& voxels) const;
  void continue_surfaces(const mapping::VoxelMap& map, const mapping::BlockIndex& index,
                         const mapping::VoxelBlock& voxels, Block& block) const;
  /// Returns the shared copy when all cells of the block are equal; otherwise the block itself.
  BlockPtr share_if_uniform(BlockPtr block);

  double resolution_m_;
  CellMeasure measure_;
  std::unordered_map<mapping::BlockIndex, BlockPtr, mapping::GridIndexHash> blocks_;
  std::map<std::pair<Real, Real>, BlockPtr> uniform_;  ///< by (free, gain)
  BlockPtr unknown_;
};

using InformationField = BasicInformationField<float>;

extern template class BasicInformationField<float>;
extern template class BasicInformationField<double>;

}  // namespace lapis::planner
