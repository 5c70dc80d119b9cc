#pragma once

#include "common/files/byte_stream.hpp"
#include "common/mapping/model/voxel_block.hpp"

namespace lapis::mapping {

/// Writes the bytes of one block, as in tiles and map files. They start with a varint word:
///   0            never observed
///   n << 2 | 1   every voxel has n misses (1/256 votes) and no hits
///   2 or 6       512 voxels follow; 6: all counts are whole votes and are written divided by 256
/// Voxels follow in the order of offset_in_block. Each record starts with a varint head:
///   run << 1      `run` voxels without hits, then their common number of misses
///   k << 1 | 1    one voxel with k classes: misses, then k times label (ascending), count (> 0)
/// Equal blocks give equal bytes. `block` may be null: a block that was never observed.
void write_block(const VoxelBlock* block, files::ByteWriter& out);

/// Inverse of write_block. Malformed input makes the reader fail; then the block is unspecified.
VoxelBlock read_block(files::ByteReader& in);

}  // namespace lapis::mapping
