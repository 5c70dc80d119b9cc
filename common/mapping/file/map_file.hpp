#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "common/mapping/file/map_description.hpp"
#include "common/mapping/model/label_list.hpp"
#include "common/mapping/model/sensor_model.hpp"
#include "common/mapping/model/voxel_map.hpp"

namespace lapis::mapping {

/// Everything in a map.lapis file: the counts, what is needed to read them as probabilities, names and colours, and how
/// frames became counts.
struct MapFile {
  VoxelMap map;
  SensorModel sensor_model;
  LabelList labels;
  std::map<std::string, std::string> provenance;  ///< free notes: source, frames, graph version, ...
  /// None: nobody knows (a file of format 2, a sum of maps that were built differently), or the map is not made of
  /// frames.
  std::optional<FrameSettings> frames = std::nullopt;
};

/// Bytes of a map file. Layout (little-endian): "LAPISMAP", format version (u32), CRC-32 of everything after it (u32),
/// size of the payload (u64), payload: one zstd frame of resolution, sensor model, labels, provenance, settings of
/// frames (one byte: whether they are known), number of blocks, blocks (index, block_codec.hpp) in canonical order.
/// Equal content gives equal bytes. The format version is 3; in files of version 2, which can be read, the settings of
/// frames are missing.
std::vector<std::uint8_t> encode_map(const MapFile& file);

/// Most memory of a map that is saved or loaded: half of that of the smallest machine, and 40 times what 10^8 voxels of
/// free space take when every block has misses that differ.
inline constexpr std::size_t kMaxMapBytes = std::size_t{4} << 30;

/// Inverse of encode_map; nothing, with the reason in `error`, for anything that is not a whole and undamaged file. The
/// content is unpacked block by block: whatever the file claims to hold, it takes the memory of its blocks, of which it
/// is refused to have more than `max_map_bytes`, and at most some 64 MB beside.
std::optional<MapFile> decode_map(std::span<const std::uint8_t> bytes, std::string& error,
                                  std::size_t max_map_bytes = kMaxMapBytes);

/// Writes beside and renames (atomic_file.hpp): returns the reason of a failure, which names the file.
[[nodiscard]] std::optional<std::string> save_map(const std::string& path, const MapFile& file);

/// Nothing, with a reason that names the file, when it cannot be read or is damaged.
std::optional<MapFile> load_map(const std::string& path, std::string& error);

}  // namespace lapis::mapping
