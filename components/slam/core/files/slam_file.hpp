#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "slam/core/files/slam_state.hpp"

namespace lapis::slam {

/// Everything in a slam.lapis file; docs/slam_file.md describes its layout.
struct SlamFile {
  std::int64_t session = 0;  ///< the one that wrote it
  SlamState state;
};

/// Bytes of a slam.lapis file. Equal content gives equal bytes. Pixels, depths, surface points and the distances of
/// landmarks keep single precision, normals 16 bits; everything else comes back as it was.
std::vector<std::uint8_t> encode_slam_file(const SlamFile& file);

/// Inverse of encode_slam_file; nothing, with the reason in `error`, for anything that is not a whole and undamaged
/// file of a sound state (find_fault). Allocates no more than a small multiple of the file's size.
std::optional<SlamFile> decode_slam_file(std::span<const std::uint8_t> bytes, std::string& error);

/// Writes beside and renames (atomic_file.hpp): returns the reason of a failure, which names the file.
[[nodiscard]] std::optional<std::string> write_slam_file(const std::string& path, const SlamFile& file);

/// Nothing, with a reason that names the file, when it cannot be read or is damaged.
std::optional<SlamFile> read_slam_file(const std::string& path, std::string& error);

}  // namespace lapis::slam
