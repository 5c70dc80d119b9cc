#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lapis::bags {

/// Largest content of a compressed chunk or message that is unpacked [bytes].
inline constexpr std::uint64_t kMostUnpacked = std::uint64_t{1} << 30;

/// Unpacks what was compressed with "zstd" (zstd frame), "lz4" (LZ4 frame) or "" (not at all). `size` is what the
/// content claims to have; memory grows with what is really there. Throws std::runtime_error with the reason.
std::vector<std::uint8_t> unpack(const std::string& compression, std::span<const std::uint8_t> packed,
                                 std::uint64_t size);

/// The same for a zstd frame whose size is not told from outside.
std::vector<std::uint8_t> unpack_zstd(std::span<const std::uint8_t> packed);

}  // namespace lapis::bags
