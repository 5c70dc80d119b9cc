#include "common/mapping/zstd_codec.hpp"

#include <stdexcept>
#include <string>

#include <zstd.h>

namespace lapis::mapping {

std::vector<std::uint8_t> zstd_compress(std::span<const std::uint8_t> bytes, int level) {
  std::vector<std::uint8_t> packed(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  return {packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size)};
}

std::optional<std::vector<std::uint8_t>> zstd_decompress(std::span<const std::uint8_t> bytes, std::size_t max_bytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > max_bytes) return std::nullopt;
  std::vector<std::uint8_t> content(static_cast<std::size_t>(size));
  const std::size_t got = ZSTD_decompress(content.data(), content.size(), bytes.data(), bytes.size());
  if (ZSTD_isError(got) || got != content.size()) return std::nullopt;
  return content;
}

}  // namespace lapis::mapping
