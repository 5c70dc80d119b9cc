#include "common/mapping/wire/frame_codec.hpp"

#include <algorithm>
#include <cstring>

#include "common/files/zstd_codec.hpp"

namespace lapis::mapping {
namespace {

constexpr int kFrameCompressionLevel = 1;
constexpr int kLargestSide = 16384;  // [px]; products of sizes cannot overflow
constexpr int kLargestStride = 16;

/// Header of a packed frame.
struct FrameHeader {
  geometry::PinholeCamera camera;
  std::uint64_t labels_out_of_list;
  std::int32_t stride;
  std::int16_t has_labels;
  std::int16_t has_confidence;

  std::size_t bytes_per_sample() const { return 2u + (has_labels ? 2u : 0u) + (has_confidence ? 1u : 0u); }
  bool is_valid() const {
    return geometry::is_valid(camera) && camera.width <= kLargestSide && camera.height <= kLargestSide && stride > 0 &&
           stride <= kLargestStride && (has_labels || !has_confidence);
  }
};

/// Header of packed votes.
struct VotesHeader {
  std::uint64_t blocks;
  std::uint64_t hits;
};

/// Buffer of this thread for the uncompressed content. It is kept because new memory from the system would cost more
/// time than the compression.
std::span<std::uint8_t> scratch(std::size_t size) {
  thread_local std::vector<std::uint8_t> buffer;
  if (buffer.size() < size) buffer.resize(size);
  return {buffer.data(), size};
}

std::optional<std::span<const std::uint8_t>> unpacked(std::span<const std::uint8_t> bytes, std::size_t header_size) {
  const auto size = files::zstd_content_size(bytes);
  if (!size || *size < header_size) return std::nullopt;
  const std::span<std::uint8_t> plain = scratch(*size);
  if (!files::zstd_decompress_into(bytes, plain)) return std::nullopt;
  return plain;
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

/// Writes an array of structures field by field, because equal fields side by side compress best.
class Columns {
 public:
  explicit Columns(std::uint8_t* at) : at_(at) {}
  template <class Record, class Field>
  void write(const std::vector<Record>& records, Field Record::*field) {
    for (const Record& record : records) {
      std::memcpy(at_, &(record.*field), sizeof(Field));
      at_ += sizeof(Field);
    }
  }

 private:
  std::uint8_t* at_;
};

class ColumnsReader {
 public:
  explicit ColumnsReader(const std::uint8_t* at) : at_(at) {}
  template <class Record, class Field>
  void read(std::vector<Record>& records, Field Record::*field) {
    for (Record& record : records) {
      std::memcpy(&(record.*field), at_, sizeof(Field));
      at_ += sizeof(Field);
    }
  }

 private:
  const std::uint8_t* at_;
};

constexpr std::size_t kBytesPerBlock = sizeof(BlockVotes::block) + sizeof(BlockVotes::misses) +
                                       sizeof(BlockVotes::hits_begin) + sizeof(BlockVotes::hits_end);
constexpr std::size_t kBytesPerHit = sizeof(HitVote::offset) + sizeof(HitVote::label) + sizeof(HitVote::weight);

}  // namespace

std::vector<std::uint8_t> pack(const CompactFrame& frame) {
  const std::size_t count = frame.samples();
  const FrameHeader header{frame.camera_, frame.labels_out_of_list_, frame.stride_, frame.has_labels(),
                           !frame.confidence_.empty()};
  const std::span<std::uint8_t> plain = scratch(sizeof header + count * header.bytes_per_sample());
  std::memcpy(plain.data(), &header, sizeof header);
  std::uint8_t* values = plain.data() + sizeof header;
  write_differences(frame.depth_mm_.data(), count, values);
  if (header.has_labels) write_differences(frame.labels_.data(), count, values + 2 * count);
  if (header.has_confidence) std::copy_n(frame.confidence_.data(), count, values + 4 * count);
  return files::zstd_compress(plain, kFrameCompressionLevel);
}

std::optional<CompactFrame> unpack_frame(std::span<const std::uint8_t> bytes) {
  FrameHeader header{};
  const auto plain = unpacked(bytes, sizeof header);
  if (!plain) return std::nullopt;
  std::memcpy(&header, plain->data(), sizeof header);
  if (!header.is_valid()) return std::nullopt;
  CompactFrame frame;
  frame.camera_ = header.camera;
  frame.stride_ = header.stride;
  frame.labels_out_of_list_ = header.labels_out_of_list;
  const std::size_t count = static_cast<std::size_t>(frame.columns()) * static_cast<std::size_t>(frame.rows());
  if (plain->size() != sizeof header + count * header.bytes_per_sample()) return std::nullopt;
  const std::uint8_t* values = plain->data() + sizeof header;
  frame.depth_mm_.resize(count);
  read_differences(values, count, frame.depth_mm_.data());
  frame.labels_.resize(header.has_labels ? count : 0);
  if (header.has_labels) read_differences(values + 2 * count, count, frame.labels_.data());
  if (header.has_confidence) frame.confidence_.assign(values + 4 * count, values + 5 * count);
  return frame;
}

std::vector<std::uint8_t> pack(const FrameVotes& votes) {
  const VotesHeader header{votes.blocks.size(), votes.hits.size()};
  const std::span<std::uint8_t> plain =
      scratch(sizeof header + header.blocks * kBytesPerBlock + header.hits * kBytesPerHit);
  std::memcpy(plain.data(), &header, sizeof header);
  Columns columns(plain.data() + sizeof header);
  columns.write(votes.blocks, &BlockVotes::block);
  columns.write(votes.blocks, &BlockVotes::hits_begin);
  columns.write(votes.blocks, &BlockVotes::hits_end);
  columns.write(votes.blocks, &BlockVotes::misses);
  columns.write(votes.hits, &HitVote::offset);
  columns.write(votes.hits, &HitVote::label);
  columns.write(votes.hits, &HitVote::weight);
  return files::zstd_compress(plain, kFrameCompressionLevel);
}

std::optional<FrameVotes> unpack_votes(std::span<const std::uint8_t> bytes) {
  VotesHeader header{};
  const auto plain = unpacked(bytes, sizeof header);
  if (!plain) return std::nullopt;
  std::memcpy(&header, plain->data(), sizeof header);
  if (plain->size() != sizeof header + header.blocks * kBytesPerBlock + header.hits * kBytesPerHit) return std::nullopt;
  FrameVotes votes;
  votes.blocks.resize(header.blocks);
  votes.hits.resize(header.hits);
  ColumnsReader columns(plain->data() + sizeof header);
  columns.read(votes.blocks, &BlockVotes::block);
  columns.read(votes.blocks, &BlockVotes::hits_begin);
  columns.read(votes.blocks, &BlockVotes::hits_end);
  columns.read(votes.blocks, &BlockVotes::misses);
  columns.read(votes.hits, &HitVote::offset);
  columns.read(votes.hits, &HitVote::label);
  columns.read(votes.hits, &HitVote::weight);
  return votes;
}

}  // namespace lapis::mapping
