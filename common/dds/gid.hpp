#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <string>

#include "common/dds/compat.hpp"

namespace lapis::dds {

/// Globally unique id of a participant, reader or writer: 12 bytes of prefix, 4 bytes of entity id, as ROS 2 shows it.
using Gid = std::array<std::uint8_t, 16>;

/// The first bytes of a Gid, the same for all endpoints of a participant.
inline constexpr std::ptrdiff_t kGidPrefixBytes = 12;

inline Gid to_gid(const compat::rtps::GUID_t& guid) {
  Gid gid{};
  for (std::size_t i = 0; i < 12; ++i) gid[i] = guid.guidPrefix.value[i];
  for (std::size_t i = 0; i < 4; ++i) gid[12 + i] = guid.entityId.value[i];
  return gid;
}

/// The bytes in hexadecimal, separated by dots, as ROS 2 prints them.
inline std::string to_text(const Gid& gid) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : gid) {
    if (!text.empty()) text += '.';
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

}  // namespace lapis::dds
