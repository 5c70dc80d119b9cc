#include "sensor_replay/core/image_file.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <vector>

#include "common/files/atomic_file.hpp"
#include "common/images/encoded_image.hpp"

namespace lapis::sensor_replay {
namespace {

constexpr std::uint16_t kNoDepth = 0;
constexpr int kMaxDepthValue = 65535;  // also means "no measurement" in some recordings

using Decoded = std::variant<cv::Mat, ImageFault>;

Decoded decode(const std::filesystem::path& file) {
  std::string reason;
  const auto bytes = files::read_file(file.string(), reason);
  if (!bytes) return ImageFault::kMissing;
  if (bytes->empty() || images::is_truncated_jpeg(*bytes)) return ImageFault::kUndecodable;
  try {
    cv::Mat image = cv::imdecode(*bytes, cv::IMREAD_UNCHANGED);
    if (image.empty()) return ImageFault::kUndecodable;
    return image;
  } catch (const cv::Exception&) {  // for example a header that announces 2^31 pixels
    return ImageFault::kUndecodable;
  }
}

Decoded decode(const std::filesystem::path& file, ImageSize size) {
  Decoded decoded = decode(file);
  if (const auto* image = std::get_if<cv::Mat>(&decoded); image && ImageSize{image->cols, image->rows} != size) {
    return ImageFault::kWrongSize;
  }
  return decoded;
}

// Table from every possible depth pixel to millimetres.
std::vector<std::uint16_t> millimetre_table(double depth_scale) {
  std::vector<std::uint16_t> table(kMaxDepthValue + 1, kNoDepth);
  for (int raw = 1; raw < kMaxDepthValue; ++raw) {
    const double millimetres = std::round(raw * 1000.0 / depth_scale);
    if (millimetres < kMaxDepthValue) table[static_cast<std::size_t>(raw)] = static_cast<std::uint16_t>(millimetres);
  }
  return table;
}

}  // namespace

std::string to_string(ImageFault fault) {
  switch (fault) {
    case ImageFault::kNotListed: return "no image at this time";
    case ImageFault::kMissing: return "file missing";
    case ImageFault::kUndecodable: return "truncated or not an image";
    case ImageFault::kWrongSize: return "wrong size";
    case ImageFault::kWrongPixelType: return "wrong number of channels or bits";
  }
  return "unknown";
}

std::variant<geometry::ColorImage, ImageFault> read_color(const std::filesystem::path& file, ImageSize size) {
  const Decoded decoded = decode(file, size);
  if (const auto* fault = std::get_if<ImageFault>(&decoded)) return *fault;
  const auto& bgr = std::get<cv::Mat>(decoded);
  if (bgr.type() != CV_8UC3) return ImageFault::kWrongPixelType;
  static_assert(sizeof(geometry::Rgb8) == 3);
  geometry::ColorImage color(bgr.cols, bgr.rows);
  cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, color.pixels.data());
  cv::mixChannels({bgr}, {rgb}, {0, 2, 1, 1, 2, 0});
  return color;
}

std::variant<DepthMillimetres, ImageFault> read_depth(const std::filesystem::path& file, ImageSize size,
                                                      double depth_scale) {
  const Decoded decoded = decode(file, size);
  if (const auto* fault = std::get_if<ImageFault>(&decoded)) return *fault;
  const auto& raw = std::get<cv::Mat>(decoded);
  if (raw.type() != CV_16UC1) return ImageFault::kWrongPixelType;
  const std::vector<std::uint16_t> table = millimetre_table(depth_scale);
  DepthMillimetres depth(raw.cols, raw.rows);
  const auto* first = raw.ptr<std::uint16_t>();  // decoded images have no padding
  std::transform(first, first + raw.total(), depth.pixels.begin(), [&](std::uint16_t value) { return table[value]; });
  return depth;
}

std::variant<geometry::LabelImage, ImageFault> read_label(const std::filesystem::path& file, ImageSize size) {
  const Decoded decoded = decode(file, size);
  if (const auto* fault = std::get_if<ImageFault>(&decoded)) return *fault;
  const auto& ids = std::get<cv::Mat>(decoded);
  if (ids.type() != CV_8UC1 && ids.type() != CV_16UC1) return ImageFault::kWrongPixelType;
  geometry::LabelImage label(ids.cols, ids.rows);
  cv::Mat target(ids.rows, ids.cols, CV_16UC1, label.pixels.data());
  ids.convertTo(target, CV_16U);
  return label;
}

std::variant<ImageSize, ImageFault> read_size(const std::filesystem::path& file) {
  const Decoded decoded = decode(file);
  if (const auto* fault = std::get_if<ImageFault>(&decoded)) return *fault;
  const auto& image = std::get<cv::Mat>(decoded);
  return ImageSize{image.cols, image.rows};
}

}  // namespace lapis::sensor_replay
