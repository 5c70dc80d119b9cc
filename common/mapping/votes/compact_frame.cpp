#include "common/mapping/votes/compact_frame.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace lapis::mapping {
namespace {

constexpr int kLargestLabel = 65534;  // 65535 is not a class
constexpr const char* kOtherConfidence = "confidence size differs from depth size";

template <class Pixel>
bool has_size_of(const geometry::PinholeCamera& camera, const geometry::Image<Pixel>& image) {
  return image.width == camera.width && image.height == camera.height;
}

/// Every stride-th pixel of a row.
template <class Pixel>
const Pixel* sample_row(const geometry::Image<Pixel>& image, int row, int stride, std::vector<Pixel>& sampled) {
  const Pixel* pixels = &image.pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width)];
  if (stride == 1) return pixels;
  for (std::size_t i = 0; i < sampled.size(); ++i) sampled[i] = pixels[i * static_cast<std::size_t>(stride)];
  return sampled.data();
}

void to_millimetres(const float* depth_m, std::size_t count, std::uint16_t* depth_mm) {
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_measured = depth_m[i] > 0.0f && depth_m[i] <= std::numeric_limits<float>::max();
    const float mm = std::min(depth_m[i] * 1000.0f + 0.5f, 65535.0f);
    depth_mm[i] = static_cast<std::uint16_t>(static_cast<std::int32_t>(is_measured ? mm : 0.0f));
  }
}

/// Copies the labels; those above `largest` become unlabelled. Returns the number of such labels.
std::size_t keep_listed(const std::uint16_t* labels, std::size_t count, std::uint16_t largest, std::uint16_t* kept) {
  std::size_t above = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_listed = labels[i] <= largest;
    kept[i] = is_listed ? labels[i] : std::uint16_t{0};
    above += is_listed ? 0 : 1;
  }
  return above;
}

}  // namespace

std::optional<CompactFrame> CompactFrame::make(const geometry::PinholeCamera& camera, const geometry::DepthImage& depth,
                                               const geometry::LabelImage* labels, const CompactFrameConfig& config,
                                               std::string& error, const geometry::ConfidenceImage* confidence) {
  error.clear();
  if (!geometry::is_valid(camera))
    error = "camera intrinsics are not valid";
  else if (config.stride < 1 || config.stride > 16)
    error = "stride is outside [1, 16]";
  else if (!has_size_of(camera, depth))
    error = "depth size differs from the camera's";
  else if (confidence && !has_size_of(camera, *confidence))
    error = kOtherConfidence;
  if (!error.empty()) return std::nullopt;

  CompactFrame frame;
  frame.camera_ = camera;
  frame.stride_ = config.stride;
  const auto columns = static_cast<std::size_t>(frame.columns());
  frame.depth_mm_.resize(columns * static_cast<std::size_t>(frame.rows()));
  std::vector<float> depth_row(columns);
  for (int row = 0; row < frame.rows(); ++row) {
    const std::size_t begin = static_cast<std::size_t>(row) * columns;
    to_millimetres(sample_row(depth, row * config.stride, config.stride, depth_row), columns, &frame.depth_mm_[begin]);
  }
  if (labels) error = frame.set_labels(*labels, confidence, config.max_label);
  return error.empty() ? std::optional(std::move(frame)) : std::nullopt;
}

std::string CompactFrame::set_labels(const geometry::LabelImage& labels, const geometry::ConfidenceImage* confidence,
                                     int max_label) {
  if (!has_size_of(camera_, labels)) return "label size differs from depth size";
  if (confidence && !has_size_of(camera_, *confidence)) return kOtherConfidence;
  const auto columns = static_cast<std::size_t>(this->columns());
  const auto largest = static_cast<std::uint16_t>(std::clamp(max_label, 0, kLargestLabel));
  labels_.resize(depth_mm_.size());
  if (confidence) confidence_.resize(depth_mm_.size());
  std::vector<std::uint16_t> label_row(columns);
  std::vector<std::uint8_t> confidence_row(columns);
  for (int row = 0; row < rows(); ++row) {
    const std::size_t begin = static_cast<std::size_t>(row) * columns;
    const int image_row = row * stride_;
    labels_out_of_list_ +=
        keep_listed(sample_row(labels, image_row, stride_, label_row), columns, largest, &labels_[begin]);
    if (!confidence) continue;
    std::copy_n(sample_row(*confidence, image_row, stride_, confidence_row), columns, &confidence_[begin]);
  }
  return "";
}

double CompactFrame::median_depth_m() const {
  std::array<std::uint32_t, 65536> count{};
  for (const std::uint16_t mm : depth_mm_) ++count[mm];
  std::size_t below = (depth_mm_.size() - count[0]) / 2 + 1;  // the median is the below-th smallest measured depth
  for (std::size_t mm = 1; mm < count.size(); ++mm) {
    if (count[mm] >= below) return static_cast<double>(mm) * 1e-3;
    below -= count[mm];
  }
  return 0.0;
}

}  // namespace lapis::mapping
