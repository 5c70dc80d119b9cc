#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slam/core/files/slam_state.hpp"
#include "slam/core/map/published_ids.hpp"

namespace lapis::slam {

/// The depth camera, and where it is beside that of colour.
struct SavedDepthCamera {
  geometry::LensCamera camera;
  geometry::Pose T_color_depth = geometry::Pose::Identity();
};

/// Everything in a slam.lapis file; docs/slam_file.md describes its layout.
struct SlamFile {
  std::int64_t session = 0;  ///< session that wrote it
  std::int64_t epoch = 0;    ///< of its landmarks
  PublishedIds keyframe_ids;
  SlamState state;
  std::optional<SavedDepthCamera> depth_camera = std::nullopt;  ///< as slam has estimated it
};

/// Bytes of a slam.lapis file. Equal content gives equal bytes. Pixels, depths, surface points and the distances of
/// landmarks are stored in single precision, normals in 16 bits; everything else is stored exactly.
std::vector<std::uint8_t> encode_slam_file(const SlamFile& file);

/// Inverse of encode_slam_file. Returns nothing, with the reason in `error`, unless the bytes are a complete and
/// undamaged file with a sound state (find_fault). Allocates no more than a small multiple of the file's size.
std::optional<SlamFile> decode_slam_file(std::span<const std::uint8_t> bytes, std::string& error);

/// Writes a file beside `path` and renames it (atomic_file.hpp). Returns the reason of a failure, which names the file.
[[nodiscard]] std::optional<std::string> write_slam_file(const std::string& path, const SlamFile& file);

/// Returns nothing, with a reason in `error` that names the file, when it cannot be read or is damaged.
std::optional<SlamFile> read_slam_file(const std::string& path, std::string& error);

}  // namespace lapis::slam
