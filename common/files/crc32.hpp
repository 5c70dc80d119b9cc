#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace lapis::files {

/// CRC-32 of IEEE 802.3 (reflected polynomial 0xEDB88320, initial and final inversion): detects every single and double
/// bit error and every burst up to 32 bits.
inline std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  static constexpr std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t remainder = i;
      for (int bit = 0; bit < 8; ++bit) remainder = (remainder >> 1) ^ (remainder & 1u ? 0xEDB88320u : 0u);
      table[i] = remainder;
    }
    return table;
  }();
  std::uint32_t crc = 0xffffffffu;
  for (const std::uint8_t byte : bytes) crc = (crc >> 8) ^ kTable[(crc ^ byte) & 0xffu];
  return ~crc;
}

}  // namespace lapis::files
