#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace lapis::mapping {

/// One zstd frame that records its content size. Same input and library, same bytes.
std::vector<std::uint8_t> zstd_compress(std::span<const std::uint8_t> bytes, int level);

/// Nothing when the input is damaged, has no content size, or would unpack to more than `max_bytes`.
std::optional<std::vector<std::uint8_t>> zstd_decompress(std::span<const std::uint8_t> bytes, std::size_t max_bytes);

/// Size of the content; nothing when the input is no zstd frame or does not say.
std::optional<std::size_t> zstd_content_size(std::span<const std::uint8_t> bytes);

/// Fills `content`; false when the input is damaged or does not unpack to exactly that many bytes.
[[nodiscard]] bool zstd_decompress_into(std::span<const std::uint8_t> bytes, std::span<std::uint8_t> content);

}  // namespace lapis::mapping
