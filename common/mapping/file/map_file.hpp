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

/// Content of a map.lapis file: the counts, the model that converts them to probabilities, names and colours of the
/// classes, and the settings with which frames became counts.
struct MapFile {
  VoxelMap map;
  SensorModel sensor_model;
  LabelList labels;
  std::map<std::string, std::string> provenance;  ///< free notes: source, frames, graph version, ...
  /// Empty when the settings are unknown (a file of format 2, or a sum of maps that were built differently), or when
  /// the map was not built from frames.
  std::optional<FrameSettings> frames = std::nullopt;
};

/// Bytes of a map file. Layout (little-endian): "LAPISMAP", format version (u32), CRC-32 of everything after it (u32),
/// size of the payload (u64), payload: one zstd frame of resolution, sensor model, labels, provenance, frame settings
/// (preceded by one byte: whether they are known), number of blocks, blocks (index, block_codec.hpp) in canonical
/// order. Equal content gives equal bytes. The format version is 3. Files of version 2, which have no frame settings,
/// can be read.
std::vector<std::uint8_t> encode_map(const MapFile& file);

/// Largest memory of a map that can be saved or loaded [bytes]: half the memory of the smallest machine, and 40 times
/// the memory of 10^8 voxels of free space in which every block has different miss counts.
inline constexpr std::size_t kMaxMapBytes = std::size_t{4} << 30;

/// Inverse of encode_map; returns nothing, with the reason in `error`, for anything that is not a complete and
/// undamaged file. The content is unpacked block by block: whatever size the file claims, unpacking needs the memory of
/// its blocks, which is limited to `max_map_bytes`, and at most about 64 MB in addition.
std::optional<MapFile> decode_map(std::span<const std::uint8_t> bytes, std::string& error,
                                  std::size_t max_map_bytes = kMaxMapBytes);

/// Replaces the file as a whole (atomic_file.hpp). Returns the reason of a failure, which names the file; nothing on
/// success.
[[nodiscard]] std::optional<std::string> save_map(const std::string& path, const MapFile& file);

/// Reads a map file. When it cannot be read or is damaged, returns nothing and sets `error` to the reason, which names
/// the file.
std::optional<MapFile> load_map(const std::string& path, std::string& error);

}  // namespace lapis::mapping
