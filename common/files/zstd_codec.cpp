#include "common/files/zstd_codec.hpp"

#include <memory>
#include <stdexcept>
#include <string>

#include <zstd.h>

namespace lapis::files {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

// Contexts and the buffer live as long as their thread, because new memory from the system costs more time than the
// compression.
struct Compressor {
  std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context{ZSTD_createCCtx(), &ZSTD_freeCCtx};
  std::vector<std::uint8_t> packed;
};

}  // namespace

std::vector<std::uint8_t> zstd_compress(std::span<const std::uint8_t> bytes, int level) {
  thread_local Compressor compressor;
  std::vector<std::uint8_t>& packed = compressor.packed;
  if (packed.size() < ZSTD_compressBound(bytes.size())) packed.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compressCCtx(compressor.context.get(), packed.data(), packed.size(), bytes.data(), bytes.size(), level);
  if (ZSTD_isError(size)) throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
  return {packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(size)};
}

std::optional<std::vector<std::uint8_t>> zstd_decompress(std::span<const std::uint8_t> bytes, std::size_t max_bytes) {
  const auto size = zstd_content_size(bytes);
  if (!size || *size > max_bytes) return std::nullopt;
  std::vector<std::uint8_t> content(*size);
  if (!zstd_decompress_into(bytes, content)) return std::nullopt;
  return content;
}

std::optional<std::size_t> zstd_content_size(std::span<const std::uint8_t> bytes) {
  const unsigned long long size = ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN) return std::nullopt;
  return static_cast<std::size_t>(size);
}

bool zstd_decompress_into(std::span<const std::uint8_t> bytes, std::span<std::uint8_t> content) {
  thread_local const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context{ZSTD_createDCtx(), &ZSTD_freeDCtx};
  const std::size_t got =
      ZSTD_decompressDCtx(context.get(), content.data(), content.size(), bytes.data(), bytes.size());
  return !ZSTD_isError(got) && got == content.size();
}

ZstdReader::ZstdReader(std::span<const std::uint8_t> frame)
    : context_(ZSTD_createDCtx(), &ZSTD_freeDCtx), frame_(frame) {}

ZstdReader::~ZstdReader() = default;

std::span<const std::uint8_t> ZstdReader::peek(std::size_t size) {
  if (window_.size() - begin_ < size && !is_done_) {
    window_.erase(window_.begin(), window_.begin() + static_cast<std::ptrdiff_t>(begin_));
    begin_ = 0;
    unpack(size + kPieceBytes);
  }
  return std::span(window_).subspan(begin_);
}

/// Fills the window up to `size` bytes, or up to the end of the content.
void ZstdReader::unpack(std::size_t size) {
  std::size_t filled = window_.size();
  window_.resize(size);
  ZSTD_inBuffer in{frame_.data(), frame_.size(), 0};
  while (filled < size && !is_done_) {
    ZSTD_outBuffer out{window_.data(), size, filled};
    const std::size_t before = in.pos;
    const std::size_t rest = ZSTD_decompressStream(context_.get(), &out, &in);
    is_whole_ = rest == 0;
    is_done_ = is_whole_ || ZSTD_isError(rest) || (out.pos == filled && in.pos == before);
    filled = out.pos;
  }
  window_.resize(filled);
  frame_ = frame_.subspan(in.pos);
}

bool ZstdReader::is_at_end() { return peek(1).empty() && is_whole_ && frame_.empty(); }

}  // namespace lapis::files
