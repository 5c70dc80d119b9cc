#include "common/bags/chunk_codec.hpp"

#include <algorithm>
#include <memory>
#include <stdexcept>

#include <lz4frame.h>

#include "common/files/zstd_codec.hpp"

namespace lapis::bags {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;
// So much memory is taken on the word of a chunk.
constexpr std::uint64_t kTrusted = std::uint64_t{64} << 20;

std::vector<std::uint8_t> unpack_lz4(std::span<const std::uint8_t> packed, std::uint64_t size) {
  LZ4F_dctx* created = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&created, LZ4F_VERSION))) {
    throw std::runtime_error("no memory for lz4");
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(created,
                                                                                     &LZ4F_freeDecompressionContext);
  std::vector<std::uint8_t> content;
  std::size_t hint = 1;  // 0: the frame is complete
  while (hint != 0 && !packed.empty() && content.size() <= size) {
    const std::size_t filled = content.size();
    std::size_t got = std::min<std::uint64_t>(kPiece, size + 1 - filled), taken = packed.size();
    content.resize(filled + got);
    hint = LZ4F_decompress(context.get(), content.data() + filled, &got, packed.data(), &taken, nullptr);
    if (LZ4F_isError(hint)) throw std::runtime_error(std::string("damaged lz4: ") + LZ4F_getErrorName(hint));
    content.resize(filled + got);
    packed = packed.subspan(taken);
    if (got == 0 && taken == 0) break;
  }
  if (hint != 0) throw std::runtime_error("lz4 that ends too early, or is larger than it claims");
  return content;
}

std::vector<std::uint8_t> unpack_zstd_up_to(std::span<const std::uint8_t> packed, std::uint64_t size) {
  files::ZstdReader reader(packed);
  std::vector<std::uint8_t> content;
  while (content.size() <= size) {
    const auto piece = reader.peek(kPiece);
    if (piece.empty()) break;
    content.insert(content.end(), piece.begin(), piece.end());
    reader.skip(piece.size());
  }
  if (!reader.is_at_end()) throw std::runtime_error("damaged zstd, or zstd that is larger than it claims");
  return content;
}

}  // namespace

std::vector<std::uint8_t> unpack(const std::string& compression, std::span<const std::uint8_t> packed,
                                 std::uint64_t size) {
  if (size > kMostUnpacked) throw std::runtime_error("a chunk that claims " + std::to_string(size) + " bytes");
  std::vector<std::uint8_t> content;
  if (compression == "zstd") {
    const bool is_direct = size <= kTrusted && files::zstd_content_size(packed) == size;
    content = is_direct ? files::zstd_decompress(packed, size).value_or(content) : unpack_zstd_up_to(packed, size);
  } else if (compression == "lz4") {
    content = unpack_lz4(packed, size);
  } else if (compression.empty()) {
    content.assign(packed.begin(), packed.end());
  } else {
    throw std::runtime_error("unknown compression '" + compression + "' (known: zstd, lz4)");
  }
  if (content.size() != size) throw std::runtime_error("a chunk that is damaged, or not as large as it claims");
  return content;
}

std::vector<std::uint8_t> unpack_zstd(std::span<const std::uint8_t> packed) {
  return unpack_zstd_up_to(packed, kMostUnpacked);
}

}  // namespace lapis::bags
