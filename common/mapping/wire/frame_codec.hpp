#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/mapping/model/frame_votes.hpp"
#include "common/mapping/votes/compact_frame.hpp"

namespace lapis::mapping {

/// Packs a compact frame, which is kept for later corrections of its pose: differences along the row, compressed with
/// zstd level 1; about 20 to 55 kB for 640x360 at stride 2. Lossless, but only for the same machine and version.
std::vector<std::uint8_t> pack(const CompactFrame& frame);

/// Packs the votes of a frame in the same way.
std::vector<std::uint8_t> pack(const FrameVotes& votes);

/// Inverse of pack; nothing when the bytes are damaged.
std::optional<CompactFrame> unpack_frame(std::span<const std::uint8_t> bytes);
std::optional<FrameVotes> unpack_votes(std::span<const std::uint8_t> bytes);

}  // namespace lapis::mapping
