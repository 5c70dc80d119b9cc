#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

struct ZSTD_DCtx_s;

namespace lapis::files {

/// One zstd frame that records its content size. The same input and library version give the same bytes.
std::vector<std::uint8_t> zstd_compress(std::span<const std::uint8_t> bytes, int level);

/// Returns nothing when the input is damaged, has no content size, or would unpack to more than `max_bytes`.
std::optional<std::vector<std::uint8_t>> zstd_decompress(std::span<const std::uint8_t> bytes, std::size_t max_bytes);

/// Size of the content [bytes]; nothing when the input is not a zstd frame or does not record its content size.
std::optional<std::size_t> zstd_content_size(std::span<const std::uint8_t> bytes);

/// Fills `content`; false when the input is damaged or does not unpack to exactly that many bytes.
[[nodiscard]] bool zstd_decompress_into(std::span<const std::uint8_t> bytes, std::span<std::uint8_t> content);

/// Unpacks one zstd frame piece by piece: the memory depends on the size of the piece that is read, not on the size
/// that the frame claims. The frame must outlive the reader.
class ZstdReader {
 public:
  explicit ZstdReader(std::span<const std::uint8_t> frame);
  ~ZstdReader();
  ZstdReader(const ZstdReader&) = delete;
  ZstdReader& operator=(const ZstdReader&) = delete;

  /// The next bytes of the content: at least `size`, or all remaining ones. Valid until the next call.
  std::span<const std::uint8_t> peek(std::size_t size);
  void skip(std::size_t size) { begin_ += size; }
  /// True when all of an undamaged frame was skipped and nothing follows it.
  bool is_at_end();

 private:
  void unpack(std::size_t size);

  std::unique_ptr<ZSTD_DCtx_s, std::size_t (*)(ZSTD_DCtx_s*)> context_;
  std::span<const std::uint8_t> frame_;  ///< not yet unpacked
  std::vector<std::uint8_t> window_;     ///< unpacked from begin_ on, not yet skipped
  std::size_t begin_ = 0;
  bool is_done_ = false;  ///< the frame is at its end, or the rest is damaged
  bool is_whole_ = false;
};

}  // namespace lapis::files
