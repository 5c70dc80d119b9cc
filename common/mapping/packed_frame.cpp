#include "common/mapping/packed_frame.hpp"

#include <span>
#include <stdexcept>

#include "common/mapping/zstd_codec.hpp"

namespace lapis::mapping {
namespace {

constexpr int kCompressionLevel = 1;

/// Buffer of this thread for the content before compression. It is kept, because fresh memory from the system would
/// cost more time than the compression.
std::span<std::uint8_t> scratch(std::size_t size) {
  thread_local std::vector<std::uint8_t> buffer;
  if (buffer.size() < size) buffer.resize(size);
  return {buffer.data(), size};
}

/// Zigzag of the difference to the left neighbour (modulo 2^16): small steps of both signs have a high byte of zero.
std::uint16_t code(std::uint16_t value, std::uint16_t left) {
  const auto step = static_cast<std::int16_t>(value - left);
  return static_cast<std::uint16_t>((step << 1) ^ (step >> 15));
}

/// Coded differences, low bytes first, then high bytes: smooth surfaces become runs.
void write_differences(const std::uint16_t* values, std::size_t count, std::uint8_t* out) {
  if (count == 0) return;
  out[0] = static_cast<std::uint8_t>(code(values[0], 0) & 0xffu);
  out[count] = static_cast<std::uint8_t>(code(values[0], 0) >> 8);
  for (std::size_t i = 1; i < count; ++i) out[i] = static_cast<std::uint8_t>(code(values[i], values[i - 1]) & 0xffu);
  out += count;
  for (std::size_t i = 1; i < count; ++i) out[i] = static_cast<std::uint8_t>(code(values[i], values[i - 1]) >> 8);
}

void read_differences(const std::uint8_t* bytes, std::size_t count, std::uint16_t* values) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto coded = static_cast<std::uint16_t>(bytes[i] | bytes[count + i] << 8);
    values[i] = static_cast<std::uint16_t>((coded >> 1) ^ -(coded & 1));
  }
  std::uint16_t left = 0;
  for (std::size_t i = 0; i < count; ++i) values[i] = left = static_cast<std::uint16_t>(values[i] + left);
}

}  // namespace

PackedFrame::PackedFrame(const CompactFrame& frame)
    : camera_(frame.camera_), stride_(frame.stride_), has_labels_(frame.has_labels()),
      labels_out_of_list_(frame.labels_out_of_list_) {
  const std::size_t count = frame.samples();
  const std::span<std::uint8_t> plain = scratch(count * (has_labels_ ? 4 : 2));
  write_differences(frame.depth_mm_.data(), count, plain.data());
  if (has_labels_) write_differences(frame.labels_.data(), count, plain.data() + 2 * count);
  bytes_ = zstd_compress(plain, kCompressionLevel);
}

CompactFrame PackedFrame::unpack() const {
  CompactFrame frame;
  frame.camera_ = camera_;
  frame.stride_ = stride_;
  frame.labels_out_of_list_ = labels_out_of_list_;
  const std::size_t count = static_cast<std::size_t>(frame.columns()) * static_cast<std::size_t>(frame.rows());
  const std::span<std::uint8_t> plain = scratch(count * (has_labels_ ? 4 : 2));
  if (!zstd_decompress_into(bytes_, plain)) throw std::logic_error("PackedFrame: damaged");
  frame.depth_mm_.resize(count);
  read_differences(plain.data(), count, frame.depth_mm_.data());
  frame.labels_.resize(has_labels_ ? count : 0);
  if (has_labels_) read_differences(plain.data() + 2 * count, count, frame.labels_.data());
  return frame;
}

}  // namespace lapis::mapping
