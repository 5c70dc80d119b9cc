#include "common/mapping/compact_frame.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/mapping/zstd_codec.hpp"

namespace lapis::mapping {
namespace {

constexpr int kCompressionLevel = 1;
constexpr int kLargestLabel = 65534;  // integration.cpp needs one value for itself

std::uint16_t to_millimetres(float depth_m) {
  if (!std::isfinite(depth_m) || depth_m <= 0.0f) return 0;
  return static_cast<std::uint16_t>(std::min(depth_m * 1000.0f + 0.5f, 65535.0f));
}

double median_m(std::vector<std::uint16_t> depth_mm) {
  std::erase(depth_mm, std::uint16_t{0});
  if (depth_mm.empty()) return 0.0;
  const auto middle = depth_mm.begin() + static_cast<std::ptrdiff_t>(depth_mm.size() / 2);
  std::nth_element(depth_mm.begin(), middle, depth_mm.end());
  return *middle * 1e-3;
}

/// Differences to the left neighbour (modulo 2^16), low bytes first, then high bytes: smooth surfaces become runs.
void append_differences(const std::vector<std::uint16_t>& values, std::vector<std::uint8_t>& out) {
  const std::size_t begin = out.size(), count = values.size();
  out.resize(begin + 2 * count);
  std::uint16_t previous = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto step = static_cast<std::uint16_t>(values[i] - previous);
    // Zigzag keeps the high byte of small negative steps zero.
    const auto coded = static_cast<std::uint16_t>((static_cast<unsigned>(step) << 1) ^ (step & 0x8000u ? 0xffffu : 0u));
    out[begin + i] = static_cast<std::uint8_t>(coded & 0xffu);
    out[begin + count + i] = static_cast<std::uint8_t>(coded >> 8);
    previous = values[i];
  }
}

void read_differences(const std::uint8_t* bytes, std::vector<std::uint16_t>& values) {
  std::uint16_t previous = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const unsigned coded = bytes[i] | static_cast<unsigned>(bytes[values.size() + i]) << 8;
    const unsigned step = (coded >> 1) ^ (coded & 1u ? 0xffffu : 0u);
    previous = static_cast<std::uint16_t>(previous + step);
    values[i] = previous;
  }
}

}  // namespace

std::optional<CompactFrame> CompactFrame::make(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth,
                                               const geometry::LabelImage* labels, const CompactFrameConfig& config,
                                               std::string& error) {
  error.clear();
  if (!geometry::is_valid(camera))
    error = "camera intrinsics are not valid";
  else if (config.stride < 1 || config.stride > 16)
    error = "stride is outside [1, 16]";
  else if (depth.width != camera.width || depth.height != camera.height)
    error = "depth size differs from the camera's";
  else if (labels && (labels->width != depth.width || labels->height != depth.height))
    error = "label size differs from depth size";
  if (!error.empty()) return std::nullopt;

  CompactFrame frame;
  frame.camera_ = camera;
  frame.stride_ = config.stride;
  frame.columns_ = (depth.width + config.stride - 1) / config.stride;
  frame.rows_ = (depth.height + config.stride - 1) / config.stride;
  frame.has_labels_ = labels != nullptr;
  Samples samples;
  for (int row = 0; row < depth.height; row += config.stride)
    for (int column = 0; column < depth.width; column += config.stride) {
      samples.depth_mm.push_back(to_millimetres(depth(column, row)));
      if (!labels) continue;
      const std::uint16_t label = (*labels)(column, row);
      const bool is_listed = label <= std::min(config.max_label, kLargestLabel);
      frame.labels_out_of_list_ += is_listed ? 0 : 1;
      samples.labels.push_back(is_listed ? label : std::uint16_t{0});
    }
  frame.median_depth_m_ = median_m(samples.depth_mm);
  std::vector<std::uint8_t> plain;
  append_differences(samples.depth_mm, plain);
  append_differences(samples.labels, plain);
  frame.data_ = zstd_compress(plain, kCompressionLevel);
  return frame;
}

CompactFrame::Samples CompactFrame::unpack() const {
  const std::size_t count = static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
  const std::size_t expected = count * (has_labels_ ? 4 : 2);
  const auto plain = zstd_decompress(data_, expected);
  if (!plain || plain->size() != expected) throw std::logic_error("CompactFrame: damaged in memory");
  Samples samples;
  samples.depth_mm.resize(count);
  read_differences(plain->data(), samples.depth_mm);
  if (has_labels_) {
    samples.labels.resize(count);
    read_differences(plain->data() + 2 * count, samples.labels);
  }
  return samples;
}

}  // namespace lapis::mapping
