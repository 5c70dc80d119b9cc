#include "common/mapping/file/map_file.hpp"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "common/files/atomic_file.hpp"
#include "common/files/byte_stream.hpp"
#include "common/files/crc32.hpp"
#include "common/files/zstd_codec.hpp"
#include "common/mapping/wire/block_codec.hpp"

namespace lapis::mapping {
namespace {

constexpr std::string_view kFileMagic = "LAPISMAP";
constexpr std::uint32_t kFormatVersion = 3;
constexpr std::uint32_t kFormerVersion = 2;  // without frame settings
constexpr int kFileCompressionLevel = 3;
// Usual and largest size of a record (everything before the blocks, or one block). The largest size allows 20,000
// classes in each voxel of a block.
constexpr std::size_t kUsualRecordBytes = std::size_t{64} << 10;
constexpr std::size_t kMaxRecordBytes = std::size_t{64} << 20;
constexpr std::int32_t kMaxBlockIndex = 1 << 26;  // voxel indices, even of a rotated map, fit into 32 bits

bool is_in_range(const BlockIndex& index) {
  const auto fits = [](std::int32_t i) { return i >= -kMaxBlockIndex && i < kMaxBlockIndex; };
  return fits(index.x) && fits(index.y) && fits(index.z);
}

void write_sensor_model(const SensorModel& model, files::ByteWriter& out) {
  for (const double value : {model.hit_gain, model.miss_gain, model.label_accuracy, model.prior_occupied,
                             model.prior_votes, model.occupancy_limit, model.share_limit})
    out.f64(value);
  out.u32(static_cast<std::uint32_t>(model.class_count));
  out.u8(model.use_paper_increments ? 1 : 0);
  out.text(model.fusion);
  out.varint(model.class_priors.size());
  for (const double prior : model.class_priors) out.f64(prior);
}

SensorModel read_sensor_model(files::ByteReader& in) {
  SensorModel model;
  for (double* value : {&model.hit_gain, &model.miss_gain, &model.label_accuracy, &model.prior_occupied,
                        &model.prior_votes, &model.occupancy_limit, &model.share_limit})
    *value = in.f64();
  model.class_count = static_cast<int>(std::min<std::uint32_t>(in.u32(), 65536u));
  model.use_paper_increments = in.u8() != 0;
  model.fusion = in.text();
  const std::uint64_t priors = in.varint();
  if (priors > in.remaining() / sizeof(double)) in.fail();
  for (std::uint64_t i = 0; i < priors && in.is_good(); ++i) model.class_priors.push_back(in.f64());
  return model;
}

void write_labels(const LabelList& labels, files::ByteWriter& out) {
  out.varint(labels.size());
  for (const Label& label : labels.labels()) {
    out.varint(label.id);
    out.text(label.name);
    out.u8(label.color.r);
    out.u8(label.color.g);
    out.u8(label.color.b);
  }
}

std::vector<Label> read_labels(files::ByteReader& in) {
  std::vector<Label> labels;
  const std::uint64_t count = in.varint();
  for (std::uint64_t i = 0; i < count && in.is_good(); ++i) {
    Label label;
    const std::uint64_t id = in.varint();
    if (id > 0xffff) in.fail();
    label.id = static_cast<std::uint16_t>(id);
    label.name = in.text();
    label.color.r = in.u8();
    label.color.g = in.u8();
    label.color.b = in.u8();
    labels.push_back(std::move(label));
  }
  return labels;
}

void write_frame_settings(const std::optional<FrameSettings>& frames, files::ByteWriter& out) {
  out.u8(frames ? 1 : 0);
  if (!frames) return;
  const IntegrationConfig& c = frames->integration;
  for (const double value : {c.min_range_m, c.max_range_m, c.min_height_m, c.max_height_m, c.end_margin_voxels,
                             c.depth_noise_per_m, c.kernel_length_voxels})
    out.f64(value);
  out.u32(static_cast<std::uint32_t>(frames->stride));
}

std::optional<FrameSettings> read_frame_settings(files::ByteReader& in) {
  if (in.u8() == 0) return std::nullopt;
  FrameSettings frames;
  IntegrationConfig& c = frames.integration;
  for (double* value : {&c.min_range_m, &c.max_range_m, &c.min_height_m, &c.max_height_m, &c.end_margin_voxels,
                        &c.depth_noise_per_m, &c.kernel_length_voxels})
    *value = in.f64();
  frames.stride = static_cast<int>(std::min<std::uint32_t>(in.u32(), 65536u));
  return frames;
}

std::vector<std::uint8_t> encode_content(const MapFile& file) {
  files::ByteWriter out;
  out.f64(file.map.resolution_m());
  write_sensor_model(file.sensor_model, out);
  write_labels(file.labels, out);
  out.varint(file.provenance.size());
  for (const auto& [key, value] : file.provenance) {
    out.text(key);
    out.text(value);
  }
  write_frame_settings(file.frames, out);
  const std::vector<BlockIndex> blocks = file.map.sorted_blocks();
  out.varint(blocks.size());
  for (const BlockIndex& index : blocks) {
    out.i32(index.x);
    out.i32(index.y);
    out.i32(index.z);
    write_block(file.map.find(index), out);
  }
  return out.take();
}

std::string memory_limit(std::size_t max_map_bytes) {
  return "more than " + std::to_string(max_map_bytes >> 20) + " MB of memory";
}

/// Everything before the blocks, and the number of blocks. Throws std::runtime_error for values out of range (most
/// checks are those of the constructors).
std::pair<MapFile, std::uint64_t> read_head(files::ByteReader& in, std::uint32_t format_version) {
  MapFile file{VoxelMap(in.f64()), {}, {}, {}};
  file.sensor_model = read_sensor_model(in);
  std::vector<Label> labels = read_labels(in);
  const std::uint64_t notes = in.varint();
  for (std::uint64_t i = 0; i < notes && in.is_good(); ++i) {
    std::string key = in.text();
    file.provenance[std::move(key)] = in.text();
  }
  if (format_version > kFormerVersion) file.frames = read_frame_settings(in);
  const std::uint64_t blocks = in.varint();
  if (!in.is_good()) return {std::move(file), 0};
  if (file.frames) validate(*file.frames, file.map.resolution_m());
  file.labels = LabelList(std::move(labels));
  static_cast<void>(BeliefReader(file.sensor_model));  // throws for a model with which counts cannot be read
  return {std::move(file), blocks};
}

std::pair<BlockIndex, VoxelBlock> read_indexed_block(files::ByteReader& in) {
  BlockIndex index;
  index.x = in.i32();
  index.y = in.i32();
  index.z = in.i32();
  VoxelBlock block = read_block(in);
  if (!is_in_range(index) || block.is_empty()) in.fail();
  return {index, std::move(block)};
}

/// Result of `read` on the next bytes. `read` is repeated with more bytes while they do not suffice; returns nothing
/// when kMaxRecordBytes or the rest of the content do not suffice.
template <class Read>
auto read_record(files::ZstdReader& content, Read&& read)
    -> std::optional<decltype(read(std::declval<files::ByteReader&>()))> {
  for (std::size_t size = kUsualRecordBytes; size <= kMaxRecordBytes; size *= 4) {
    const auto bytes = content.peek(size);
    files::ByteReader in(bytes);
    auto record = read(in);
    if (in.is_good()) {
      content.skip(bytes.size() - in.remaining());
      return record;
    }
    if (bytes.size() < size) break;
  }
  return std::nullopt;
}

/// Throws std::runtime_error for values out of range.
std::optional<MapFile> decode_content(files::ZstdReader& content, std::uint32_t format_version,
                                      std::size_t max_map_bytes) {
  auto head = read_record(content, [&](files::ByteReader& in) { return read_head(in, format_version); });
  if (!head) return std::nullopt;
  auto& [file, blocks] = *head;
  std::optional<BlockIndex> previous;
  std::size_t bytes = 0;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    auto indexed = read_record(content, read_indexed_block);
    if (!indexed || (previous && !(*previous < indexed->first))) return std::nullopt;
    bytes += indexed->second.bytes();
    if (bytes > max_map_bytes) throw std::runtime_error("a map of " + memory_limit(max_map_bytes));
    previous = indexed->first;
    file.map.set_block(indexed->first, std::move(indexed->second));
  }
  if (!content.is_at_end()) return std::nullopt;
  return std::move(file);
}

struct Payload {
  std::uint32_t format_version = 0;
  std::span<const std::uint8_t> bytes;
};

/// Checks the header and returns the payload; returns nothing and sets `error` to the reason when the header is not
/// valid.
std::optional<Payload> check_header(std::span<const std::uint8_t> bytes, std::string& error) {
  files::ByteReader in(bytes);
  const auto magic = in.raw(kFileMagic.size());
  if (!in.is_good() || !std::equal(magic.begin(), magic.end(), kFileMagic.begin())) {
    error = "is not a Lapis map";
    return std::nullopt;
  }
  const std::uint32_t version = in.u32();
  if (in.is_good() && version != kFormatVersion && version != kFormerVersion) {
    error = "has format version " + std::to_string(version) + ", this program reads " + std::to_string(kFormerVersion) +
            " and " + std::to_string(kFormatVersion);
    return std::nullopt;
  }
  const std::uint32_t crc = in.u32();
  const std::size_t covered = in.remaining();
  const std::uint64_t size = in.u64();
  if (!in.is_good() || in.remaining() != size) {
    error = "is truncated or has bytes after its end";
    return std::nullopt;
  }
  if (files::crc32(bytes.last(covered)) != crc) {
    error = "is damaged: the checksum differs";
    return std::nullopt;
  }
  return Payload{version, in.raw(size)};
}

}  // namespace

std::vector<std::uint8_t> encode_map(const MapFile& file) {
  files::ByteWriter checked;
  const std::vector<std::uint8_t> payload = files::zstd_compress(encode_content(file), kFileCompressionLevel);
  checked.u64(payload.size());
  checked.raw(payload);
  files::ByteWriter out;
  for (const char c : kFileMagic) out.u8(static_cast<std::uint8_t>(c));
  out.u32(kFormatVersion);
  out.u32(files::crc32(checked.bytes()));
  out.raw(checked.bytes());
  return out.take();
}

std::optional<MapFile> decode_map(std::span<const std::uint8_t> bytes, std::string& error, std::size_t max_map_bytes) {
  const auto payload = check_header(bytes, error);
  if (!payload) return std::nullopt;
  try {
    files::ZstdReader content(payload->bytes);
    auto file = decode_content(content, payload->format_version, max_map_bytes);
    if (!file) error = "is damaged: the content is malformed";
    return file;
  } catch (const std::runtime_error& reason) {
    error = std::string("has a value out of range: ") + reason.what();
    return std::nullopt;
  }
}

std::optional<std::string> save_map(const std::string& path, const MapFile& file) {
  if (file.map.bytes() > kMaxMapBytes) return path + ": not written: a map of " + memory_limit(kMaxMapBytes);
  return files::replace_file(path, encode_map(file));
}

std::optional<MapFile> load_map(const std::string& path, std::string& error) {
  const auto bytes = files::read_file(path, error);
  if (!bytes) return std::nullopt;
  auto file = decode_map(*bytes, error);
  if (!file) error = path + ": " + error;
  return file;
}

}  // namespace lapis::mapping
